"""CPU seconds of `run` on every sample case with two programs: `python3 samples.py BEFORE AFTER [runs]`, one thread, the least of the runs.

The programs take turns, so that other load meets both. A case that one of them does not pass is an error.
"""

import os
import pathlib
import subprocess
import sys
import tempfile


def seconds(program, case):
    """User and system seconds of one run."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", str(case), "--out", f"{folder}/out", "--threads", "1", "--quiet"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        if status != 0:
            raise SystemExit(f"{' '.join(command)}: exit {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime


def main():
    programs, runs = sys.argv[1:3], int(sys.argv[3]) if len(sys.argv) > 3 else 5
    cases = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples" / "cases").glob("*.toml"))
    print("| case | before [s] | after [s] | after / before |\n| --- | --- | --- | --- |")
    for case in cases:
        least = [float("inf")] * 2
        for _ in range(runs):
            for k, program in enumerate(programs):
                least[k] = min(least[k], seconds(program, case))
        print(f"| {case.stem} | {least[0]:.3f} | {least[1]:.3f} | {least[1] / least[0]:.2f} |")


main()
