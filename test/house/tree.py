"""The files of the project as the guards of test/house and scripts/traceability read them."""
import os
import subprocess

SKIPPED_FOLDERS = {".git", "build", "out", "node_modules", "__pycache__", "dist"}


def project_files(root):
    """Paths relative to `root`, sorted: what git knows or would add; without git, what lies in the folders."""
    if os.path.exists(os.path.join(root, ".git")):
        listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                                check=True, capture_output=True).stdout.decode()
        paths = {path for path in listed.split("\0") if path}
        return sorted(path for path in paths if os.path.isfile(os.path.join(root, path)))
    paths = []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if name not in SKIPPED_FOLDERS]
        paths += [os.path.relpath(os.path.join(folder, name), root) for name in names]
    return sorted(paths)


def read_text(root, path):
    """The text of a file, or None if it is not UTF-8 text."""
    with open(os.path.join(root, path), "rb") as file:
        data = file.read()
    if b"\0" in data:
        return None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return None
