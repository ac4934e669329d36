"""What the series of scripts/ share: worlds and seeds of the command line, and results that are kept, so that a stopped series goes on."""
import argparse
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def seeds_of(text):
    """A..B, or one seed."""
    first, _, last = text.partition("..")
    return range(int(first), int(last or first) + 1)


def parser_of(doc, seeds, worlds):
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=os.path.abspath)
    parser.add_argument("--seeds", type=seeds_of, default=seeds)
    parser.add_argument("--worlds", type=lambda text: text.split(","), default=worlds)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build/release/bin"))
    return parser


def runs_of(args):
    """World, seed and folder of each run."""
    return [(world, seed, os.path.join(args.folder, world, f"seed{seed}")) for world in args.worlds for seed in args.seeds]


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def program(binaries, name, *arguments, codes=(0,)):
    """The object in the last line of its output. @param codes of its end that are no failure."""
    done = subprocess.run([os.path.join(binaries, name), *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    lines = done.stdout.strip().splitlines()
    if done.returncode not in codes or not lines:
        sys.exit(f"{name} {' '.join(arguments)} ended with {done.returncode}\n{done.stderr}")
    return json.loads(lines[-1])


def kept(path, make):
    """What `make` returns, or returned when a series ran before: the object in the file."""
    if not os.path.exists(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        os.replace(write(path + ".part", json.dumps(make())), path)
    return json.loads(read(path))
