"""Devices, and the contexts that extractions run in: kept between calls, told of Ctrl-C, one thread in each at a time."""
import contextlib
import ctypes
import os
import signal
import threading
import warnings
import weakref
from dataclasses import dataclass

from . import trial
from .library import (DeviceError, check, options, tc, tc_context_options, tc_device_info, tc_engine,
                      tc_expert_options, tc_progress)

ENGINES = ("auto", "opencl", "reference")


@dataclass(frozen=True)
class Device:
    """One OpenCL device; sizes are in bytes."""

    index: int  #: what ``device=`` takes
    platform_index: int
    device_index: int
    platform: str
    name: str
    version: str
    driver: str
    type: str  #: "cpu", "gpu", "accelerator" or "other"
    compute_units: int
    max_work_group_size: int
    global_memory_bytes: int
    max_buffer_bytes: int
    local_memory_bytes: int
    shares_host_memory: bool
    has_fp64: bool
    rounds_division: bool


def devices() -> list[Device]:
    """The OpenCL devices of all platforms, in the order of their numbers.

    Without OpenCL the list is empty, and a warning says what to install; the reference engine works all the same.
    """
    count = ctypes.c_int()
    try:
        check(tc.tc_device_count(ctypes.byref(count)))
    except DeviceError as error:
        warnings.warn(str(error), RuntimeWarning, stacklevel=2)
    return [_device(index) for index in range(count.value)]


def _device(index):
    info = tc_device_info()
    check(tc.tc_device_get(index, ctypes.byref(info)))
    found = {name: getattr(info, name) for name in Device.__dataclass_fields__ if name != "index"}
    for name, value in found.items():
        if isinstance(value, bytes):
            found[name] = value.decode(errors="replace")
    for name in ("shares_host_memory", "has_fp64", "rounds_division"):
        found[name] = bool(found[name])
    return Device(index=index, **found)


class Context:
    """A device, or the reference engine. Its calls release the interpreter's lock and have a lock of their own."""

    def __init__(self, engine, device=None, max_memory=0, cl_context=None, cl_queue=None):
        self.progress = None  # told of the call under way: progress(stage, fraction)
        self.raised = None  # by progress, or by a signal, while the library runs
        self._lock = threading.RLock()
        self._busy = False
        self._keep = [tc_progress(self._tell), trial.callback(self)]
        expert = options(tc_expert_options)
        expert.child_trial = self._keep[1]
        how = options(tc_context_options)
        how.engine = engine
        how.device = os.fsencode(device) if device is not None else None
        how.cl_context, how.cl_queue = cl_context, cl_queue
        how.max_memory_bytes = max_memory
        how.progress = self._keep[0]
        how.check_device = 1
        how.expert = ctypes.pointer(expert)
        self.handle = ctypes.c_void_p()
        self.call(tc.tc_context_create, ctypes.byref(how), ctypes.byref(self.handle))
        # Destroying it writes what was built to the cache, also where the interpreter ends.
        self._end = weakref.finalize(self, tc.tc_context_destroy, self.handle)

    def _tell(self, _user, stage, fraction):
        try:
            if self.progress and not self.raised:
                self.progress(stage.decode(), fraction)
        except BaseException as error:  # pylint: disable=broad-except; raised again when the library has returned
            self.raised = error
        return self.raised is not None

    def call(self, function, *arguments):
        """Calls the library. What the progress callback or a signal raises meanwhile cancels it, and is raised here."""
        with self._lock:
            if self._busy:
                raise RuntimeError("a progress callback must not use the grid, or the device, of the call it is told of")
            self._busy, self.raised = True, None
            try:
                with self._signals_wait():
                    status = function(*arguments)
            finally:
                self._busy = False
            raised, self.raised = self.raised, None
            if raised is not None:
                raise raised
            check(status)

    @contextlib.contextmanager
    def _signals_wait(self):
        """Ctrl-C ends the library's call; its handler's exception would be lost in a callback, so it is kept."""
        handler = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is not threading.main_thread() or not callable(handler):
            yield
            return

        def keep(number, frame):
            try:
                handler(number, frame)
            except BaseException as error:  # pylint: disable=broad-except; raised again by call()
                self.raised = error

        signal.signal(signal.SIGINT, keep)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, handler)


# Contexts that nobody uses at the moment, by what they were made for.
_free: dict = {}
_free_lock = threading.Lock()


def _forked():
    """A forked child has no use for its parent's OpenCL, and nobody who would release the lock."""
    global _free_lock  # pylint: disable=global-statement
    _free_lock = threading.Lock()
    _free.clear()


os.register_at_fork(after_in_child=_forked)


def _kept(engine, device, max_memory):
    """A context that is free, or a new one. give_back() keeps it for the next."""
    key = engine, device, max_memory, device is None and os.environ.get("TETRACUBES_DEVICE")
    with _free_lock:
        if _free.get(key):
            return _free[key].pop()
    context = Context(engine, device, max_memory)
    context.key = key
    return context


def take(engine, device, max_memory):
    """The context for what the caller of a public function asked for."""
    if engine not in ENGINES:
        raise ValueError(f"engine is {engine!r}, not one of {', '.join(ENGINES)}")
    for name, given in ("device", device), ("max_memory", max_memory):
        if engine == "reference" and given is not None:
            warnings.warn(f"{name} has no effect with engine='reference', which uses no device", RuntimeWarning, stacklevel=4)
    try:
        max_memory = 0 if max_memory is None else int(max_memory)
    except (TypeError, ValueError):
        max_memory = repr(max_memory)
    if isinstance(max_memory, str) or max_memory < 0:
        raise ValueError(f"max_memory is {max_memory}, not a number of bytes")
    device = None if device is None else str(device)
    if engine != "reference":
        try:
            return _kept(tc_engine.TC_ENGINE_OPENCL, device, max_memory)
        except DeviceError as error:
            if engine == "opencl":
                raise
            warnings.warn(f"{error}. The reference engine does the work now: the same mesh, on one core", RuntimeWarning,
                          stacklevel=4)
    return _kept(tc_engine.TC_ENGINE_REFERENCE, None, 0)


def give_back(context):
    """Keeps a context of take() for later calls."""
    context.progress = None
    with _free_lock:
        _free.setdefault(context.key, []).append(context)
