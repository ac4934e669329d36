#!/usr/bin/python3
"""`experiment --workers` over the IceGrid servers of deploy/icegrid, on one machine. Tests E6, C3.

Workers are killed at random moments, and the master once: the table is that of one process, CPU times apart.
FARM_KILLS, FARM_TRIALS and FARM_EVENT_S make it longer.
"""
import json
import os
import random
import signal
import subprocess
import sys
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from site_of_robots import LOCATOR, ROOT, DEPLOY, Site, children_of, enter_own_network, wait_for  # noqa: E402

BIN = os.environ.get("VISMEM_BIN", os.path.join(ROOT, "build/release/bin"))
KILLS = int(os.environ.get("FARM_KILLS", 6))
TRIALS = int(os.environ.get("FARM_TRIALS", 6))
EVENT_S = int(os.environ.get("FARM_EVENT_S", 15))
WORKERS = 4
RUN_LIMIT_S = 3600
TIMES = {"cpu_ms_mean", "cpu_ms_p99", "took_s", "out", "command"}

VARIANTS = f"""E6.Variant.farm.Title = short events in the corridor with two wings alike
E6.Variant.farm.World = corridor
E6.Variant.farm.Twins = yes
E6.Variant.farm.Events = 2
E6.Variant.farm.Event_s = {EVENT_S}
E6.Variant.farm.Trials = {TRIALS}
E6.Variant.farm.Methods = default chapter
"""


def without_times(table):
    if not isinstance(table, dict):
        return table
    return {key: without_times(value) for key, value in table.items() if key not in TIMES}


class Farm(unittest.TestCase):
    def setUp(self):
        self.site = self.enterContext(Site())
        self.variants = os.path.join(self.site.folder.name, "farm.variants")
        with open(self.variants, "w") as file:
            file.write(VARIANTS)

    def command(self, out, *more):
        return [os.path.join(BIN, "experiment"), "E6", "--variants", self.variants, "--out",
                os.path.join(self.site.folder.name, out), *more]

    def over_workers(self, out):
        return self.command(out, "--workers", "Worker@Workers", "--locator", LOCATOR)

    def start_master(self):
        master = subprocess.Popen(self.over_workers("spread"), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: master.poll() is not None or master.kill())
        return master

    def table(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        return without_times(json.loads(done.stdout.strip().splitlines()[-1]))

    def events(self, out):
        with open(os.path.join(self.site.folder.name, out, "farm_events.csv")) as file:
            return file.read()

    def test_the_table_is_that_of_one_process_whoever_dies(self):
        begin = time.monotonic()
        alone = self.table(subprocess.run(self.command("alone"), capture_output=True, text=True, timeout=RUN_LIMIT_S))
        alone_s = time.monotonic() - begin
        self.site.start_registry()
        self.site.start_replica()
        node = self.site.start_node()
        self.site.admin(f"application add '{DEPLOY}/icegrid/application.xml' programs='{BIN}' folder='{ROOT}'", check=True)
        self.assertEqual(len(self.site.admin("server list").stdout.split()), WORKERS)
        draw = random.Random(1)
        begin = time.monotonic()
        master = self.start_master()
        wait_for(lambda: len(children_of(node.pid)) == min(WORKERS, TRIALS) or master.poll() is not None, 60, "all workers run")
        killed = 0
        while killed < KILLS and master.poll() is None:
            time.sleep(draw.uniform(0.2, 3.0))
            workers = children_of(node.pid)
            if not workers:
                continue
            os.kill(draw.choice(workers), signal.SIGKILL)
            killed += 1
            if killed == KILLS // 2:
                master.kill()
                master.communicate()
                master = self.start_master()
        out, err = master.communicate(timeout=RUN_LIMIT_S)
        spread = self.table(subprocess.CompletedProcess([], master.returncode, out, err))
        print(f"fleet: {TRIALS} trials: {alone_s:.0f} s in one process, {time.monotonic() - begin:.0f} s over {WORKERS} "
              f"workers with {killed} of them and the master killed", flush=True)
        self.assertEqual(killed, KILLS, "the run was over before")
        self.assertEqual(spread, alone)
        self.assertEqual(self.events("spread"), self.events("alone"))


if __name__ == "__main__":
    for program in ("icegridregistry", "icegridnode", "icegridadmin"):
        if subprocess.run(["which", program], capture_output=True).returncode != 0:
            print(f"fleet: skipped, no {program}: scripts/setup fleet")
            sys.exit(77)
    if not enter_own_network():
        print("fleet: skipped, the kernel allows no network of its own (needs root or user namespaces)")
        sys.exit(77)
    unittest.main(verbosity=2)
