"""Files of a setup: keys read and set; one that says who is at work."""
import difflib
import fcntl
import os
import re
import shutil


class Failure(Exception):
    def __init__(self, text, code=1):
        super().__init__(text)
        self.code = code


def reason_of(error):
    """Of an OSError: what it was about, and why."""
    return f"{error.filename}: {error.strerror}" if error.filename else str(error.strerror or error)


def say(text):
    print(text, flush=True)


def read_text(path):
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except UnicodeDecodeError as error:
        raise Failure(f"{path}: byte {error.start + 1} is not UTF-8 (expected a text in UTF-8)") from None


def locked(path):
    """The open file, until it is closed this process's alone; None when another process has it."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    file = os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT, 0o600), "r+", encoding="utf-8")
    os.chmod(file.fileno(), 0o600)  # also of a copied folder: the page's address is a secret
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        return None
    return file


def write_locked(file, text):
    file.truncate(0)
    file.write(text + "\n")
    file.flush()


def key_of(line):
    found = re.match(r"\s*([A-Za-z0-9_.]+)\s*=", line)
    return found.group(1) if found else None


def value_of(path, key):
    """Of a key in a file; None if it is not set."""
    for line in read_text(path).splitlines():
        if key_of(line) == key:
            return line.split("=", 1)[1].split(" #")[0].strip()
    return None


def set_keys(path, values, instead_of=None):
    """Sets keys, each where it stood; shows the difference and keeps the file before as .old.
    @param instead_of pattern of other keys that are left out."""
    before = read_text(path).splitlines()
    after, left = [], dict(values)
    for line in before:
        key = key_of(line)
        if key in values:
            if key in left:
                after.append(f"{key} = {left.pop(key)}")
        elif not (key and instead_of and re.fullmatch(instead_of, key)):
            after.append(line)
    after += [f"{key} = {value}" for key, value in left.items()]
    if after == before:
        return
    shutil.copyfile(path, path + ".old")
    with open(path + ".new", "w", encoding="utf-8") as file:  # a full disk must not empty the file
        file.write("\n".join(after) + "\n")
    os.replace(path + ".new", path)
    say("\n".join(difflib.unified_diff(before, after, path + ".old", path, lineterm="")))
