"""expect.py - as expect.h: checks that print what failed and go on, and the count of those that did"""
import subprocess

failures = 0


def expect(condition, text):
    global failures
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def finish():
    """Prints the count; the exit status of the test."""
    print(f"{failures} failed")
    return int(failures > 0)


def run(*command, **more):
    """A finished process with its streams as text."""
    return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          check=False, **more)
