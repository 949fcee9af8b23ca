#!/usr/bin/env python3
"""test_endings.py TOOL STRIKE - runs that come to a bad end: signals, disks, pipes, inputs that change

Every command that writes, in every format, is struck at an exact moment by STRIKE, the library that strike.c makes:
interrupted, killed, out of space. What may be left is what was there before; after a kill also a temporary file, whose
name tells what it is. Needs no OpenCL device: the reference engine makes what is written. Standard library only.
"""
import errno
import fcntl
import os
import re
import resource
import signal
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case

STRIKE = None
OLD = b"what was there before"
NOBODY = 65534


class EndCase(tool_case.Case):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("noise", "a.nrrd", "40,30,20", "f32")
        self.extract = ["extract", self.volume, "--iso", "127.5", "--engine", "reference", "--quiet"]

    def outputs(self):
        """Every command that writes, with each of its formats, and the name it is to write."""
        for ending in ("ply", "vtp", "stl", "obj", "off", "glb", "html", "npz"):
            yield [*self.extract, "-o"], f"out.{ending}"
        yield [*self.extract, "--blocks", "separate", "-o"], "block.ply"
        yield ["tetrahedralize", self.volume, "--quiet", "-o"], "out.vtu"
        for ending in ("nrrd", "raw"):
            yield ["generate", "noise", "--dims", "128,128,128", "--type", "f32", "--quiet", "-o"], f"out.{ending}"

    def written(self, name):
        return name.replace("block.", "block_b0.")

    def struck(self, status, arguments, says=None, **strike):
        environment = dict(strike, LD_PRELOAD=STRIKE)
        result = tool_case.tool(*arguments, env=environment)
        told = f"{arguments} {strike}: status {result.returncode}, {result.stderr!r}"
        self.assertEqual(result.returncode, status, told)
        if says:
            self.assertRegex(result.stderr, says, told)
        return result

    def each(self, check):
        """check(arguments, name) for every output, where there is no such file, and where there is one: it stays."""
        for before in (None, OLD):
            for arguments, name in self.outputs():
                path = self.path(self.written(name))
                if before:
                    with open(path, "wb") as file:
                        file.write(before)
                files = self.files()
                with self.subTest(arguments=arguments, before=before):
                    left = check([*arguments, self.path(name)], self.written(name))
                    self.assertEqual(self.files(), sorted(files + left))
                    if before:
                        with open(path, "rb") as file:
                            self.assertEqual(file.read(), before)
                for file in left + ([self.written(name)] if before else []):
                    os.unlink(self.path(file))


class Struck(EndCase):
    def test_nothing_strikes(self):
        for arguments, name in self.outputs():
            self.struck(0, [*arguments, self.path(name)], STRIKE_WRITE=f"1000 signal {signal.SIGINT.value}")
            self.assertIn(self.written(name), self.files())

    def test_signals_cancel(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGXCPU, signal.SIGHUP):
            def check(arguments, _):
                self.struck(tool_case.cancelled_by(number), arguments, "cancelled; no file was left unfinished",
                            STRIKE_WRITE=f"1 signal {number.value}")
                return []
            self.each(check)

    def test_signals_cancel_with_kernels(self):
        """Compilers of kernels put handlers of their own before others'."""
        self.needs_device()
        arguments = ["extract", self.volume, "--iso", "127.5", "-o", self.path("out.ply")]
        cache = {"TETRACUBES_CACHE_DIR": self.path("cache")}
        os.mkdir(self.path("cache"), 0o700)
        self.expect(0, *arguments, env=cache)  # kernels and verdicts are kept from here on: what is written is the mesh
        os.unlink(self.path("out.ply"))
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT, signal.SIGXCPU, signal.SIGHUP):
            before = self.files()
            self.struck(tool_case.cancelled_by(number), arguments, "cancelled; no file was left unfinished",
                        STRIKE_WRITE=f"1 signal {number.value}", **cache)
            self.assertEqual(self.files(), before)

    def test_second_signal_ends_at_once(self):
        """Nobody reads the pipe, so the run cannot go on to where it would see the first."""
        os.mkfifo(self.path("pipe.obj"))
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT):
            process = subprocess.Popen([tool_case.TOOL, *self.extract, "-o", self.path("pipe.obj")],
                                       stderr=subprocess.PIPE, preexec_fn=lambda: resource.setrlimit(
                                           resource.RLIMIT_CORE, (0, 0)))
            self.addCleanup(process.kill)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.5)
            process.send_signal(number)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.5)
            process.send_signal(number)
            self.assertEqual(process.wait(100), -number)
            process.stderr.close()

    def test_kill(self):
        def check(arguments, name):
            before = self.files()
            self.struck(-signal.SIGKILL, arguments, STRIKE_WRITE=f"1 signal {signal.SIGKILL.value}")
            left = [file for file in self.files() if file not in before]
            self.assertEqual(len(left), 1)
            self.assertRegex(left[0], "^" + re.escape(f".{name}.") + r"[0-9a-f]{6}\.tmp$")
            return left
        self.each(check)

    def test_what_was_killed_goes(self):
        """The next run of the same name removes what a killed one left, and nothing else."""
        for arguments, name in self.outputs():
            written = self.written(name)
            path = self.path(name)
            self.struck(-signal.SIGKILL, [*arguments, path], STRIKE_WRITE=f"1 signal {signal.SIGKILL.value}")
            [left] = [file for file in self.files() if file.endswith(".tmp")]
            others = [f".{written}.12345.tmp", f".{written}.12345g.tmp", f".x{written}.123456.tmp",
                      f"{written}.123456.tmp", f".{written}.abcdef.tmp.old"]
            for other in others:
                self.write_file(other)
            locked = self.write_file(f".{written}.abcdef.tmp")  # of a run that goes on
            os.symlink("a.nrrd", self.path(f".{written}.fedcba.tmp"))
            with open(locked, "rb") as held:
                fcntl.flock(held, fcntl.LOCK_EX)
                self.expect(0, *arguments, path)
                self.assertNotIn(left, self.files())
                self.assertEqual([other for other in others if other not in self.files()], [])
                self.assertIn(os.path.basename(locked), self.files())
            self.expect(0, *arguments, path)
            self.assertNotIn(os.path.basename(locked), self.files())
            self.assertIn("a.nrrd", self.files())
            for file in self.files():
                if file != "a.nrrd":
                    os.unlink(self.path(file))

    def write_file(self, name):
        with open(self.path(name), "wb") as file:
            file.write(OLD)
        return self.path(name)

    def test_full_disk(self):
        for number, says in ((errno.ENOSPC, "No space left.*free space"), (errno.EDQUOT, "quota"),
                             (errno.EIO, "Input/output")):
            for write in (0, 1):
                def check(arguments, name):
                    self.struck(1, arguments, f"{re.escape(name)}.*{says}", STRIKE_WRITE=f"{write} error {number}")
                    return []
                self.each(check)

    def test_what_ends_a_file_fails(self):
        for strike in ("STRIKE_CLOSE", "STRIKE_RENAME", "STRIKE_OPEN"):
            def check(arguments, name):
                self.struck(1, arguments, f"{re.escape(name)}.*Input/output", **{strike: str(errno.EIO)})
                return []
            self.each(check)


class Places(EndCase):
    def test_unwritable(self):
        for arguments, name in self.outputs():
            for place, says in (("no/folder", "create the folder"), ("a.nrrd", "Not a directory"), ("/proc", ".")):
                self.refuses(1, *arguments, os.path.join(self.path(place), name), says=says)

    def test_folders_are_looked_at_first(self):
        """A long extraction, and an input that cannot be read: the folder is told of before either."""
        for arguments, name in self.outputs():
            if "generate" in arguments:
                continue
            words = [word.replace("a.nrrd", "broken.nrrd") for word in arguments]
            with open(self.path("broken.nrrd"), "w") as file:
                file.write("no volume")
            self.refuses(1, *words, os.path.join(self.path("no/folder"), name), says="create the folder")
            self.refuses(4, *words, self.path(name), says="broken.nrrd")

    def test_links_are_followed(self):
        os.mkdir(self.path("there"))
        for arguments, name in self.outputs():
            written = self.written(name)
            for target in (os.path.join("there", written), os.path.join(self.path("there"), written), "second"):
                os.symlink(target, self.path(written))
                os.symlink(os.path.join("there", written), self.path("second"))
                for _ in range(2):  # to where nothing is yet; to a file
                    self.expect(0, *arguments, self.path(name))
                    self.assertTrue(os.path.islink(self.path(written)))
                    self.assertEqual(os.listdir(self.path("there")), [written])
                    self.assertGreater(os.path.getsize(self.path(written)), 0)
                os.unlink(os.path.join(self.path("there"), written))
                os.unlink(self.path(written))
                os.unlink(self.path("second"))
            os.symlink(os.path.join("nowhere", written), self.path(written))
            self.refuses_link(arguments, name, "create the folder")
            os.unlink(self.path(written))
            os.symlink(written, self.path(written))
            self.refuses_link(arguments, name, "symbolic links")
            os.unlink(self.path(written))

    def refuses_link(self, arguments, name, says):
        self.expect(1, *arguments, self.path(name), says=says)
        self.assertTrue(os.path.islink(self.path(self.written(name))))

    def test_folder_of_another(self):
        if os.getuid():
            locked, drop = self.path("locked"), None
        else:  # root may write anywhere: be nobody
            locked, drop = self.path("locked"), lambda: os.setuid(NOBODY)
            os.chmod(self.folder.name, 0o755)
        os.mkdir(locked, 0o555)
        for arguments, name in self.outputs():
            try:
                result = subprocess.run([tool_case.TOOL, *arguments, os.path.join(locked, name)], stderr=subprocess.PIPE,
                                        text=True, preexec_fn=drop, timeout=1000)
            except PermissionError:
                self.skipTest("nobody may not run the tool here")
            self.assertEqual(result.returncode, 1, result)
            self.assertRegex(result.stderr, re.escape(os.path.splitext(name)[0]) + ".*Permission denied")
            self.assertEqual(os.listdir(locked), [])

    def test_small_disk(self):
        disk = self.path("disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", disk], capture_output=True).returncode:
            self.skipTest("only root mounts disks")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        for arguments, name in self.outputs():
            self.expect(1, *arguments, os.path.join(disk, name), says="No space left.*free space")
            self.assertEqual(os.listdir(disk), [])

    def test_closed_pipe(self):
        shapes = ([*self.extract, "--format", "obj", "-o", "/dev/stdout"], ["info", self.volume],
                  ["generate", "noise", "--dims", "128,128,128", "--type", "u8", "-o", "/dev/stdout"],
                  ["extract", "--help"])
        for arguments in shapes:
            for handling, statuses in ((signal.SIG_DFL, (-signal.SIGPIPE,)), (signal.SIG_IGN, (1,))):
                if "generate" in arguments:
                    os.symlink("/dev/stdout", self.path("pipe.raw"))
                    arguments = [*arguments[:-1], self.path("pipe.raw")]
                reader, writer = os.pipe()
                os.close(reader)
                result = subprocess.run([tool_case.TOOL, *arguments], stdout=writer, stderr=subprocess.PIPE, text=True,
                                        restore_signals=False, timeout=1000,
                                        preexec_fn=lambda: signal.signal(signal.SIGPIPE, handling))
                os.close(writer)
                if os.path.islink(self.path("pipe.raw")):
                    os.unlink(self.path("pipe.raw"))
                self.assertIn(result.returncode, statuses, (arguments, result))
                if handling == signal.SIG_IGN:
                    self.assertIn("Broken pipe", result.stderr)
                self.assertEqual(self.files(), ["a.nrrd"])

    def test_output_is_data_of_the_input(self):
        """A detached header names the file: it is as much the input as the header."""
        self.generate("sphere", "samples.raw", "20,20,20", "u8")
        with open(self.path("a.nhdr"), "w") as file:
            file.write("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 20 20 20\nencoding: raw\ndata file: samples.raw\n")
        with open(self.path("a.mhd"), "w") as file:
            file.write("ObjectType = Image\nNDims = 3\nDimSize = 20 20 20\nElementType = MET_UCHAR\n"
                       "ElementDataFile = samples.raw\n")
        os.link(self.path("samples.raw"), self.path("same.vtu"))
        os.symlink("samples.raw", self.path("link.ply"))
        for header in ("a.nhdr", "a.mhd"):
            for output in ("samples.raw", "same.vtu", "link.ply"):
                self.refuses(2, "extract", self.path(header), "--iso", "100", "--engine", "reference", "--format",
                             "ply", "-o", self.path(output), says="read as part of it")
            self.refuses(2, "tetrahedralize", self.path(header), "-o", self.path("same.vtu"), says="read as part of it")
            os.link(self.path("samples.raw"), self.path("block_b0.ply"))
            self.refuses(2, "extract", self.path(header), "--iso", "100", "--engine", "reference", "--blocks", "separate",
                         "-o", self.path("block.ply"), says="block_b0.ply is a file that the input names")
            os.remove(self.path("block_b0.ply"))
        self.expect(0, "extract", self.path("a.nhdr"), "--iso", "100", "--engine", "reference", "-o",
                    self.path("fine.ply"))


class Inputs(EndCase):
    def commands(self, volume):
        for ending in ("ply", "vtp", "stl", "obj", "off", "glb", "html", "npz"):
            yield ["extract", volume, "--iso", "127.5", "--engine", "reference", "--quiet", "-o"], f"out.{ending}"
        yield ["extract", volume, "--iso", "127.5", "--engine", "reference", "--json"], None
        yield ["extract", volume, "--iso", "127.5", "--engine", "reference", "--count"], None
        yield ["tetrahedralize", volume, "--quiet", "-o"], "out.vtu"
        yield ["info", volume], None
        if tool_case.HAS_DEVICE:
            yield ["extract", volume, "--iso", "127.5", "-o"], "out.ply"
            yield ["extract", volume, "--iso", "127.5", "--engine", "auto", "-o"], "out.ply"
            yield ["extract", volume, "--iso", "127.5", "--verify"], None

    def content(self, name):
        if not name:
            return None
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_input_shrinks(self):
        """Cut when it has been mapped, for its header or for its samples: pages are gone that are read later."""
        whole = self.content(self.volume)
        for closing, bytes_left in ((1, 0), (2, 0), (2, 8192), (2, len(whole) // 2)):
            for arguments, name in self.commands(self.volume):
                result = self.struck(4, [*arguments, *([self.path(name)] if name else [])],
                                     STRIKE_TRUNCATE=f"{closing} {bytes_left} {self.volume}")
                self.assertRegex(result.stderr, "became shorter" if closing == 2 else "a.nrrd|became shorter")
                self.assertEqual(result.stdout, "")
                self.assertEqual(self.files(), ["a.nrrd"])
                with open(self.volume, "wb") as file:
                    file.write(whole)

    def test_input_changes(self):
        """The input is written to after it was mapped: samples that were never there together make no surface."""
        whole = self.content(self.volume)
        for at in (2000, len(whole) - 1):
            for arguments, name in self.commands(self.volume):
                result = self.struck(4, [*arguments, *([self.path(name)] if name else [])], "was written to while",
                                     STRIKE_ALTER=f"2 {at} {self.volume}")
                self.assertEqual(result.stdout, "")
                self.assertEqual(self.files(), ["a.nrrd"])
                with open(self.volume, "wb") as file:
                    file.write(whole)

    def test_input_vanishes(self):
        """What is mapped stays."""
        whole = self.content(self.volume)
        for arguments, name in self.commands(self.volume):
            more = [self.path(name)] if name else []
            self.expect(0, *arguments, *more)
            expected = self.content(name)
            self.struck(0, [*arguments, *more], STRIKE_UNLINK=f"2 0 {self.volume}")
            self.assertEqual(self.content(name), expected)
            self.assertFalse(os.path.exists(self.volume))
            with open(self.volume, "wb") as file:
                file.write(whole)


if __name__ == "__main__":
    STRIKE = os.path.abspath(sys.argv[2])
    tool_case.signals_as_usual()
    tool_case.main()
