"""How calls run: progress, Ctrl-C, threads, devices, no OpenCL at all, the tool, the end of the interpreter."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import tetracubes
from tetracubes import context as contexts
from tetracubes import library, trial


@pytest.fixture(scope="module")
def noise():
    """What takes the reference engine a while."""
    return np.random.default_rng(1).random((64, 96, 96)).astype(np.float32)


def python(code, **environment):
    """Runs code in a Python of its own."""
    return subprocess.run([sys.executable, "-c", "import numpy, tetracubes\n" + code], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, env={**os.environ, **environment}, check=False)


def test_progress(noise):
    told = []
    tetracubes.isosurface(noise, 0.5, engine="reference", progress=lambda stage, fraction: told.append((stage, fraction)))
    assert len(told) > 2 and all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in told)


def test_arguments_without_effect(noise):
    """As in the tool: a threshold of another method is refused; what is of devices alone has a warning."""
    with pytest.raises(ValueError, match="snap is the threshold of method 'snap', and method is 'tetra'"):
        tetracubes.isosurface(noise, 0.5, snap=0.2)
    for name, value in ("device", 0), ("max_memory", 1e9):
        with pytest.warns(RuntimeWarning, match=f"{name} has no effect with engine='reference'"):
            tetracubes.isosurface(noise, 0.5, engine="reference", **{name: value})
    for value in "1G", -1, [3]:
        with pytest.raises(ValueError, match="max_memory is .*, not a number of bytes"):
            tetracubes.isosurface(noise, 0.5, max_memory=value)
    for name in 1, "a\0b":
        with pytest.raises(ValueError, match="carry has the name .*, which is no text"):
            tetracubes.isosurface(noise, 0.5, carry={name: noise}, engine="reference")
    with pytest.raises(ValueError, match="volume is a list, which has no shape"):
        tetracubes.isosurface_by_parts(noise.tolist(), 0.5)


def test_exception_of_progress_ends_the_call(noise):
    def stop(stage, fraction):
        raise OverflowError("enough")

    with pytest.raises(OverflowError, match="enough"):
        tetracubes.isosurface(noise, 0.5, engine="reference", progress=stop)
    assert len(tetracubes.isosurface(noise, 0.5, engine="reference").faces)


def test_interrupt_ends_the_call(noise):
    told = []

    def press(stage, fraction):
        told.append(fraction)
        os.kill(os.getpid(), signal.SIGINT)

    handler = signal.getsignal(signal.SIGINT)
    with tetracubes.Grid(noise, engine="reference", progress=press) as grid:
        with pytest.raises(KeyboardInterrupt):
            grid.extract(0.5)
        assert len(told) == 1 and signal.getsignal(signal.SIGINT) is handler
        grid._context.progress = None
        assert grid.extract(0.5).hash == tetracubes.isosurface(noise, 0.5, engine="reference").hash


def test_interrupt_from_outside(noise):
    """Without a progress callback, while the library works; pressed by another thread."""
    large = np.tile(noise, (3, 2, 2))
    timer = threading.Timer(0.1, os.kill, [os.getpid(), signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt) as caught:
        tetracubes.isosurface(large, 0.5, engine="reference")
    assert not str(caught.value)  # it is Python's own, not the library's word that a callback has failed
    timer.join()


def test_progress_must_not_use_the_grid(noise):
    with tetracubes.Grid(noise, engine="reference", progress=lambda *_: grid.count(0.5)) as grid:
        with pytest.raises(RuntimeError, match="must not use"):
            grid.extract(0.5)


def test_other_threads_run_meanwhile(noise):
    """The interpreter's lock is released: this thread goes on while another one is in the library."""
    worker = threading.Thread(target=lambda: tetracubes.isosurface(noise, 0.5, engine="reference"))
    waits = 0
    worker.start()
    while worker.is_alive():
        time.sleep(0.001)
        waits += 1
    assert waits > 5


def test_threads(noise):
    """Calls of several threads at once, each in a context of its own, which later calls use again."""
    hashes = []
    threads = [threading.Thread(target=lambda level=level: hashes.append(
        (level, tetracubes.isosurface(noise, level, engine="reference").hash))) for level in (0.4, 0.5, 0.6, 0.5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert dict(hashes) == {level: tetracubes.isosurface(noise, level, engine="reference").hash
                            for level in (0.4, 0.5, 0.6)} and len(hashes) == 4
    free = {key: len(kept) for key, kept in contexts._free.items()}
    assert 1 <= sum(free.values()) <= 20
    tetracubes.isosurface(noise, 0.5, engine="reference")
    assert free == {key: len(kept) for key, kept in contexts._free.items()}


def test_device_makes_the_same(ball):
    """OpenCL, where there is a device."""
    found = tetracubes.devices()
    if not found:
        pytest.skip("no OpenCL device")
    assert found[0].index == 0 and found[0].name and found[0].global_memory_bytes > 0
    options = {"normals": True, "carry": {"ball": ball}}
    mesh = tetracubes.isosurface(ball, 0.5, engine="opencl", device=0, **options)
    wanted = tetracubes.isosurface(ball, 0.5, engine="reference", **options)
    assert mesh.hash == wanted.hash and (mesh.normals == wanted.normals).all()
    np.testing.assert_allclose(mesh.values["ball"], 0.5, atol=1e-4)
    small = tetracubes.isosurface(ball, 0.5, engine="opencl", device=0, max_memory=2_000_000)
    assert small.hash == wanted.hash
    with pytest.raises(MemoryError, match="allow [0-9]+ or more"):
        tetracubes.isosurface(ball, 0.5, engine="opencl", device=0, max_memory=200_000)


def test_no_such_device(ball):
    with pytest.raises(tetracubes.DeviceError, match="no such thing"):
        tetracubes.isosurface(ball, 0, engine="opencl", device="no such thing")
    with pytest.warns(RuntimeWarning, match="no such thing.* reference engine"):
        assert len(tetracubes.isosurface(ball, 0, device="no such thing").faces)


def test_no_opencl():
    """Import works, a warning says what to install, and the reference engine does the work."""
    done = python("print(tetracubes.devices(), tetracubes.isosurface(numpy.eye(4)[None].repeat(2, 0), .5))",
                  OCL_ICD_VENDORS="/nonexistent", OCL_ICD_FILENAMES="")
    assert done.returncode == 0 and done.stdout.startswith("[] <tetracubes.Mesh: "), done.stderr
    assert "RuntimeWarning" in done.stderr and "install" in done.stderr and "reference engine" in done.stderr


def test_end_of_interpreter():
    """Meshes and grids that are still there at the end do no harm."""
    done = python("volume = numpy.random.rand(9, 9, 9)\n"
                  "grid = tetracubes.Grid(volume, engine='reference')\nmesh = grid.extract(.5)\n"
                  "import atexit; atexit.register(lambda: print(mesh.hash == grid_hash))\ngrid_hash = mesh.hash")
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\n", "")


def test_children():
    """A forked child uses the reference engine, and is told so where its parent has used OpenCL."""
    done = python("import os\nvolume = numpy.random.rand(9, 9, 9)\nwanted = tetracubes.isosurface(volume, .5).hash\n"
                  "child = os.fork()\n"
                  "if child: print(os.waitpid(child, 0)[1])\n"
                  "else: print(tetracubes.isosurface(volume, .5).hash == wanted, flush=True)")
    assert (done.returncode, done.stdout) == (0, "True\n0\n"), done.stderr
    assert "fork" in done.stderr or not tetracubes.devices()


def test_tool():
    for arguments, status, text in (["--version"], 0, f"tetracubes {tetracubes.__version__}\n"), (["extract"], 2, ""):
        done = subprocess.run([sys.executable, "-m", "tetracubes", *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, check=False)
        assert done.returncode == status and done.stdout.startswith(text)


def test_trials_of_drivers(monkeypatch, tmp_path):
    """What became of the process that tried a driver is the verdict."""
    assert trial._run("no job") == (library.tc_verdict.TC_VERDICT_REFUSED, trial._run("no job")[1])
    assert "job" in trial._run("no job")[1]
    monkeypatch.setattr(trial, "_SECONDS", 0.01)
    assert trial._run("no job")[0] == library.tc_verdict.TC_VERDICT_HUNG
    monkeypatch.setattr(trial, "_SECONDS", 60)
    (tmp_path / "driver").write_text("#!/bin/sh\necho end 0\necho oh >&2\nkill -SEGV $$\n")
    (tmp_path / "driver").chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "driver"))
    assert trial._run("no job") == (library.tc_verdict.TC_VERDICT_CRASHED, "oh")
    monkeypatch.setattr(sys, "executable", "/nonexistent")
    assert trial._run("no job")[0] == library.tc_verdict.TC_VERDICT_NONE
