"""Drivers that are not known to be good are tried in a process of their own, which they may crash (tc_trial_run)."""
import ctypes
import os
import subprocess
import sys

from .library import FOLDER, message, tc, tc_child_trial, tc_progress, tc_status, tc_verdict

_SECONDS = 180  # a compiler may take a minute on a busy machine; a driver that hangs does so for good

_VERDICTS = {
    tc_status.TC_OK: tc_verdict.TC_VERDICT_GOOD,
    tc_status.TC_ERROR_WRONG_RESULT: tc_verdict.TC_VERDICT_WRONG_RESULT,
    tc_status.TC_ERROR_MEMORY: tc_verdict.TC_VERDICT_STOPPED,
}


def _run(job):
    """The verdict on a job, and the last line that its process said."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [str(FOLDER.parent),
                                                                             os.environ.get("PYTHONPATH")]))}
    try:
        done = subprocess.run([sys.executable, "-m", "tetracubes.trial", job], env=environment, timeout=_SECONDS,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=False)
    except subprocess.TimeoutExpired:
        return tc_verdict.TC_VERDICT_HUNG, f"no end after {_SECONDS} s"
    except (OSError, TypeError):  # no interpreter to start, as where Python is embedded
        return tc_verdict.TC_VERDICT_NONE, ""
    said = (done.stderr.strip().splitlines() or [""])[-1]
    if done.returncode or not done.stdout.startswith("end "):
        return tc_verdict.TC_VERDICT_CRASHED, said or f"ended with status {done.returncode}"
    return _VERDICTS.get(int(done.stdout.split()[1]), tc_verdict.TC_VERDICT_REFUSED), said


def callback(context):
    """What a context's expert options take as child_trial."""
    def tried(_user, job, reason, reason_bytes):
        try:
            verdict, said = _run(job.decode())
        except BaseException as error:  # pylint: disable=broad-except; raised again by Context.call
            context.raised = error
        if context.raised is not None:
            return tc_verdict.TC_VERDICT_CANCELLED
        line = said.encode()[:reason_bytes - 1] + b"\0"
        ctypes.memmove(reason, line, len(line))
        return verdict

    return tc_child_trial(tried)


if __name__ == "__main__":
    STATUS = tc.tc_trial_run(sys.argv[1].encode(), tc_progress(), None)
    print(message() if STATUS else "", file=sys.stderr)
    print("end", STATUS)
