# SPDX-License-Identifier: MIT
"""What a system test needs: owsd, owsctl and the genuine owserver, started and always ended.

    import owsdtest

    def test_a_temperature_arrives(scene):
        server = scene.owserver(mock=["28"])
        daemon = scene.owsd(owsdtest.rio(server.target, [
            dict(Name="room", Path=server.devices()[0] + "/temperature", Type="double", IO="input"),
        ]))
        scene.until(lambda: scene.get(daemon, "room"), 10, "room is good")

    if __name__ == "__main__":
        owsdtest.main()

Every function test_* is a case; its name is the sentence that is shown. A case fails by an
exception (assert will do), and is skipped by owsdtest.skip("why"). Every wait has a deadline.
"""

import atexit
import concurrent.futures
import contextlib
import itertools
import os
import pathlib
import queue
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import traceback

SOURCE = pathlib.Path(os.environ.get("OWSD_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
BUILD = pathlib.Path(os.environ.get("OWSD_BUILD", SOURCE / "build"))
OWSD = BUILD / "owsd"
OWSCTL = BUILD / "owsctl"
PYTHON = BUILD / "python"  # for PYTHONPATH; `import ows` after this module finds it
sys.path.insert(0, str(PYTHON))
NOP, READ, WRITE, DIRALL = 1, 2, 3, 7
# The longest that a busy machine, a sanitizer and other tests beside may make of the seconds of a wait
PATIENCE = 90
QUIET_PATIENCE = 20
_serial = itertools.count(1)
_ports = []  # names that keep the ports for us, until we end


def folder():
    """A folder for all cases of this program; it is removed at the end of the program."""
    path = tempfile.mkdtemp(prefix="cases-")
    atexit.register(shutil.rmtree, path, ignore_errors=True)
    return pathlib.Path(path)


# What is started here has its files in a place of the test's own, not where an owsd of this machine
# has them; tests/system/run gives one too
if "OWS_DIR" not in os.environ:
    os.environ["OWS_DIR"] = str(folder() / "owsd")


def place():
    """The directory of owsd's files."""
    return pathlib.Path(os.environ["OWS_DIR"])


place().mkdir(mode=0o755, exist_ok=True)


def segment(name, kind):
    """A file of an instance."""
    return place() / f"{name}.{kind}"


class Skip(Exception):
    pass


class Late(AssertionError):
    """A condition did not come true in time."""


def skip(why):
    raise Skip(why)


def need(program):
    assert program.exists(), f"{program} is not built"


def with_sim(program, *words, cwd="."):
    """The program for these arguments: the one that is packaged, or where they, or a file that they
    name, have a simulated target, its like that has simulated devices (owsd-sim for owsd)."""
    def simulated(word):
        file = os.path.join(cwd, str(word))
        text = pathlib.Path(file).read_bytes() if os.path.isfile(file) else b""
        return any(scheme in str(word).encode() + text for scheme in (b"sim:", b"replay:"))
    return program.with_name(program.name + "-sim") if any(map(simulated, words)) else program


def patience(seconds):
    """What those seconds are at the load of now: QUIET_PATIENCE at least, and more in proportion to
    what waits for each processor. A sanitizer's code is slow."""
    load = os.getloadavg()[0] / (os.cpu_count() or 1)
    slow = 2 if BUILD.name in ("asan", "tsan") else 1
    return max(seconds, min(PATIENCE, QUIET_PATIENCE * slow * max(1, load)))


def but_of_here(text):
    """What owsd --check reports, without the lines about what this machine has not."""
    return "".join(line for line in text.splitlines(True) if " is not on this machine: " not in line)


def until(condition, seconds, what="", step=0.02):
    """Wait until condition() is true and return its value; fail after so many seconds, but not
    before patience() is over. what is said then: a text, or a function that makes it."""
    begun = time.monotonic()
    while True:
        passed = time.monotonic() - begun
        late = passed >= seconds and passed >= patience(seconds)
        value = condition()
        if value:
            return value
        if late:
            raise Late(f"not within {passed:.0f} s: {what() if callable(what) else what or condition}")
        time.sleep(step)  # pace


def settled(look, times=20, step=0.05):
    """What look() says when it has said the same so often: for a second, if nothing else."""
    seen = []

    def same():
        seen.append(look())
        return seen[-times:] == seen[-1:] * times
    until(same, PATIENCE, lambda: f"it settles: {seen[-times:]}", step)
    return seen[-1]


def worked(instance, seconds):
    """Wait until the engine of this instance (a name, or an open ows.Ows) has beaten for so long:
    what it has to do in that time is done, however busy the machine is."""
    import ows
    with ows.Ows(instance) if isinstance(instance, str) else contextlib.nullcontext(instance) as signals:
        def beat():
            now = ows.now_ns()
            return now - signals.beat_age(now) * 1e9
        until(beat, 10, "the engine's heart beats")
        begun = beat()
        until(lambda: beat() - begun >= seconds * 1e9, seconds + 10, "the engine works on")


def open_files(process):
    """The numbers of its descriptors."""
    return sorted(int(n) for n in os.listdir(f"/proc/{process.pid}/fd"))


def state_of(pid, task=None):
    """R, S, D, T, Z as in proc(5)."""
    with open(f"/proc/{pid}/task/{task or pid}/stat", encoding="ascii", errors="replace") as file:
        return file.read().rpartition(")")[2].split()[0]


def logged(daemon, text):
    """The log is written beside the work: what was said stands there soon."""
    until(lambda: text in daemon.log(), 10, lambda: f"{text!r} in the log:\n{daemon.log()}")


def _unused(port):
    """No socket of this machine has the port. A socket that tried it could outlive its close(): a child
    that another thread starts just then has it until it runs its program."""
    rows = ""
    for kind in ("tcp", "tcp6"):
        with contextlib.suppress(FileNotFoundError):
            rows += pathlib.Path("/proc/net", kind).read_text()
    return f":{port:04X} " not in rows


def free_port():
    """A port that is ours until this process ends: no other test is given it, nor is it one that the
    kernel gives to those who do not care which."""
    for port in random.sample(range(10240, 32768), 1000):
        keep = socket.socket(socket.AF_UNIX)
        try:
            keep.bind(f"\0owsd.test.port.{port}")
        except OSError:
            keep.close()
            continue
        _ports.append(keep)
        if _unused(port):
            return port
    raise AssertionError("no free port")


@contextlib.contextmanager
def default_port():
    """The port of owserver on this machine, 4304, and so what `auto` finds: for one test at a time."""
    def have():
        with contextlib.suppress(OSError):
            keep.bind("\0owsd.test.port.4304")
            return True
        return False
    with socket.socket(socket.AF_UNIX) as keep:
        until(have, 300, "no other test has port 4304", step=0.1)
        yield 4304


def need_ipv6():
    try:
        with socket.socket(socket.AF_INET6) as s:
            s.bind(("::1", 0))
    except OSError as why:
        skip(f"no IPv6 here: {why}")


class raw(str):
    """A value that rio() writes without quotes: raw("0x0018")."""


def rio(target, items, **driver):
    """The text of a configuration; items are dictionaries of keys. Text is quoted, numbers not."""
    def value(v):
        return str(v) if isinstance(v, (int, float, raw)) else f'"{v}"'

    keys = {"Version": raw("1.00"), "TargetName": target, **driver, "ItemCount": len(items)}
    lines = ["OwsDrv {"]
    lines += [f"  {key:23} {value(v)}" for key, v in keys.items()]
    for item in items:
        lines.append("  Item {")
        lines += [f"    {key:23} {value(v)}" for key, v in item.items()]
        lines.append("  }")
    return "\n".join(lines + ["}", ""])


class Program:
    """A process of ours with its output in a file."""

    last_signal = signal.SIGTERM

    def __init__(self, scene, command, env=None):
        self.command = [str(c) for c in command]
        self.log_path = scene.path / f"log{next(_serial)}"
        with open(self.log_path, "wb") as out:
            self.process = subprocess.Popen(self.command, cwd=scene.path, stdin=subprocess.DEVNULL,
                                            stdout=out, stderr=subprocess.STDOUT,
                                            env=dict(os.environ, **(env or {})))
        self.pid = self.process.pid
        scene.programs.append(self)

    def log(self):
        return self.log_path.read_text(errors="replace")

    def running(self):
        return self.process.poll() is None

    def signal(self, number):
        self.process.send_signal(number)

    def freeze(self):
        """SIGSTOP; returns when all its threads have stopped."""
        self.signal(signal.SIGSTOP)
        os.waitid(os.P_PID, self.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)

    def thaw(self):
        self.signal(signal.SIGCONT)

    def wait(self, seconds=QUIET_PATIENCE):
        """The exit status; fails if it does not end in time."""
        until(lambda: not self.running(), seconds, f"{self.command[0]} ends", step=0.005)
        return self.process.returncode

    def kill(self):
        """SIGKILL; returns when it is gone."""
        self.process.kill()
        return self.wait()

    def stop(self, seconds=QUIET_PATIENCE):
        """SIGTERM (owserver: SIGKILL); returns the exit status."""
        self.thaw()
        self.signal(self.last_signal)
        return self.wait(seconds)


class Owserver(Program):
    """The genuine owserver with simulated devices on a port of its own."""

    # It does not always end at its first SIGTERM, and has nothing to save
    last_signal = signal.SIGKILL

    def __init__(self, scene, port, buses, host, options, env=None):
        self.host, self.port, self.buses, self.options = host, port, buses, list(options)
        self.target = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        # In a file: owserver aborts when its command line exceeds about 480 bytes
        conf = scene.file(f"owserver-{port}.conf",
                          "".join(f"{kind} = {','.join(ids)}\n" for kind, ids in buses))
        super().__init__(scene, [shutil.which("owserver"), "-c", conf, "-p",
                                 f"{host}:{port}",  # it knows no brackets
                                 "--foreground", *self.options], env)

    def request(self, kind, path="", data=b"", size=8192, flags=0x10A, seconds=60):
        """One request on a connection of its own: (ret, payload)."""
        body = path.encode() + b"\0" + data if path else b""
        with socket.create_connection((self.host, self.port), timeout=seconds) as s:
            s.sendall(struct.pack(">6i", 0, len(body), kind, flags,
                                  len(data) if kind == WRITE else size, 0) + body)
            while True:
                _, length, ret, _, _, _ = struct.unpack(">6i", self._exactly(s, 24))
                if length >= 0:
                    return ret, self._exactly(s, length)

    @staticmethod
    def _exactly(s, n):
        data = b""
        while len(data) < n:
            more = s.recv(n - len(data))
            if not more:
                raise ConnectionError("owserver closed the connection")
            data += more
        return data

    def answers(self):
        try:
            return self.request(NOP, seconds=5)[0] == 0
        except OSError:
            return False

    def read(self, path):
        ret, data = self.request(READ, path)
        if ret < 0:
            raise OSError(-ret, f"owserver: read {path}: {ret}")
        return data.decode("latin-1").strip()

    def write(self, path, value):
        """Write; returns owserver's answer (a mock device takes also what it answers an error to)."""
        return self.request(WRITE, path, str(value).encode("latin-1"))[0]

    def devices(self, bus=None):
        """Paths of all devices, or of those on bus number so and so, sorted. Tester ids are the same
        in every run; fake and mock ids are if there is only one bus of these two kinds."""
        ret, data = self.request(DIRALL, "/" if bus is None else f"/bus.{bus}")
        if ret < 0:
            raise OSError(-ret, f"owserver: dirall: {ret}")
        names = (p.rsplit("/", 1)[1] for p in data.rstrip(b"\0").decode().split(",") if p)
        return sorted("/" + n for n in names if len(n) == 15 and n[2] == ".")


class Manager:
    """The service manager's end: takes at once what a program tells, as systemd does, while that runs.
    Of what a socket has: what the cases want."""

    def __init__(self, address):
        self.address = address
        self.told = queue.SimpleQueue()
        self.timeout = None
        self.end = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.end.bind(address)
        os.chmod(address, 0o777)  # owsd may run as another user

    def begin(self, running):
        threading.Thread(target=self._take, args=(running,), daemon=True).start()

    def _take(self, running):
        self.end.settimeout(0.5)
        goes_on = True
        while goes_on:
            goes_on = running()
            with contextlib.suppress(socket.timeout):
                while True:
                    self.told.put(self.end.recv(4096))
        self.end.close()

    def getsockname(self):
        return self.address

    def settimeout(self, seconds):
        self.timeout = seconds

    def setblocking(self, blocks):
        self.timeout = None if blocks else 0

    def recv(self, _size):
        try:
            return self.told.get(self.timeout != 0, self.timeout)
        except queue.Empty:
            raise (socket.timeout if self.timeout else BlockingIOError)() from None


class Owsd(Program):
    def __init__(self, scene, config, name, options, env, prefix):
        self.name = name
        self.config = config
        address = str(scene.path / f"n{next(_serial)}")
        self.notify = Manager(address)
        program = with_sim(OWSD, config or "", *options, cwd=scene.path)
        need(program)
        super().__init__(scene, [*prefix, program, "-n", name, *(["-c", config] if config else []),
                                 *options],
                         {"NOTIFY_SOCKET": address, **(env or {})})
        self.notify.begin(self.running)

    def ready(self, seconds=None):
        """Wait until it says READY=1 to the service manager, no longer than the seconds; without
        them as long as until() does."""
        begun = time.monotonic()
        self.notify.settimeout(0.05)
        while True:
            try:
                if b"READY=1" in self.notify.recv(4096).split(b"\n"):
                    return self
            except socket.timeout:
                pass
            if not self.running():
                raise AssertionError(f"owsd ended with status {self.process.returncode}")
            passed = time.monotonic() - begun
            if passed > (patience(0) if seconds is None else seconds):
                raise Late(f"owsd not ready within {passed:.0f} s")


class Scene:
    """One case's processes, files and instance names; leaving it ends and removes them all."""

    until = staticmethod(until)

    def __init__(self):
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="s"))
        self.programs = []
        self.names = []

    open = set()  # by all threads

    def __enter__(self):
        self.open.add(self)
        return self

    def __exit__(self, kind, _value, _trace):
        self.open.discard(self)
        for program in reversed(self.programs):
            if program.running():
                program.thaw()
                program.process.send_signal(program.last_signal)
        for program in reversed(self.programs):
            try:
                program.process.wait(20)
            except subprocess.TimeoutExpired:
                program.process.kill()
                program.process.wait()
        if kind is not None and not issubclass(kind, Skip):
            for program in self.programs:
                print(f"--- {' '.join(program.command)}: status {program.process.returncode}")
                print("\n".join(program.log().splitlines()[-60:]))
        for name in self.names:
            for path in place().glob(f"{name}.*"):
                with contextlib.suppress(OSError):
                    os.unlink(path)
        shutil.rmtree(self.path, ignore_errors=True)

    def file(self, name, text):
        path = self.path / name
        path.write_text(text)
        return path

    def name(self):
        """An instance name that nobody uses, nor did who was killed and left something of it."""
        name = f"T{os.getpid()}x{next(_serial)}x{os.urandom(2).hex()}"
        self.names.append(name)
        return name

    def start(self, command, env=None):
        """Any program that is to end with the case."""
        return Program(self, command, env)

    def owserver(self, fake=(), tester=(), mock=(), port=None, host="127.0.0.1", options=(), env=None):
        """Start owserver with simulated buses in this order, and wait until it answers."""
        if shutil.which("owserver") is None:
            skip("owserver is not installed")
        buses = [(kind, ids) for kind, ids in
                 (("fake", fake), ("tester", tester), ("mock", mock)) if ids]
        for _attempt in range(1 if port else 5):
            server = Owserver(self, port or free_port(), buses, host, options, env)
            until(lambda: server.answers() or not server.running(), 10, "owserver answers")
            if server.running():
                return server
        raise AssertionError("owserver did not start")

    def again(self, server):
        """The same owserver on the same port after it was ended."""
        new = Owserver(self, server.port, server.buses, server.host, server.options)
        until(lambda: new.answers() or not new.running(), 10, "owserver answers again")
        assert new.running(), "owserver did not start again"
        return new

    def owsd(self, config, *options, name=None, env=None, ready=True, prefix=()):
        """Start owsd with the text (or the path) of a configuration, None: without -c; ready unless
        said otherwise. prefix: a program that becomes owsd, with its arguments."""
        name = name or self.name()
        if isinstance(config, str):
            config = self.file(f"{name}-{next(_serial)}.rio", config)
        daemon = Owsd(self, config, name, options, env, prefix)
        return daemon.ready() if ready else daemon

    def owsd_once(self, *arguments, seconds=20):
        """Run owsd to its end (--check, -V, a faulty file): returncode, stdout, stderr."""
        program = with_sim(OWSD, *arguments, cwd=self.path)
        need(program)
        return self._run([program, *arguments], seconds)

    def owsctl(self, daemon, *arguments, seconds=20):
        """Run owsctl on an owsd (or an instance name, or None): returncode, stdout, stderr."""
        program = with_sim(OWSCTL, *arguments, cwd=self.path)
        need(program)
        name = daemon.name if isinstance(daemon, Owsd) else daemon
        return self._run([program, *(["-n", name] if name else []), *arguments], seconds)

    def _run(self, command, seconds):
        return subprocess.run([str(c) for c in command], cwd=self.path, text=True,
                              timeout=max(seconds, PATIENCE), stdin=subprocess.DEVNULL, capture_output=True)

    def get(self, daemon, name):
        """The text of a good value, else None."""
        done = self.owsctl(daemon, "get", name)
        return done.stdout.rstrip("\n") if done.returncode == 0 else None


def _run_case(name, case):
    """Its line is printed; returns what became of it: 0 passed, 1 failed, 2 skipped."""
    started = time.monotonic()
    try:
        with Scene() as scene:
            case(scene)
    except Skip as why:
        print(f"skip {name}: {why}")
        return 2
    except Exception:
        print(f"FAIL {name}\n{traceback.format_exc()}", end="")
        return 1
    print(f"ok   {name} ({time.monotonic() - started:.1f} s)")
    return 0


def _end(*_):
    """At SIGTERM. Cases of other threads cannot be ended, but what they have started can."""
    for scene in list(Scene.open):
        for program in list(scene.programs):
            if program.running():
                program.process.kill()
        shutil.rmtree(scene.path, ignore_errors=True)
    os._exit(143)


def main(at_once=1):
    """Run the cases of the calling script, or those named on the command line; so many at once,
    where they mostly wait."""
    module = vars(sys.modules["__main__"])
    cases = {n: f for n, f in module.items() if n.startswith("test_") and callable(f)}
    signal.signal(signal.SIGTERM, _end if at_once > 1 else lambda *_: sys.exit(143))
    names = sys.argv[1:] or list(cases)
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        ends = [pool.submit(_run_case, n, cases[n]) for n in names if at_once > 1]
        ended = [end.result() for end in ends] or [_run_case(n, cases[n]) for n in names]
    passed, failed, skipped = (ended.count(what) for what in range(3))
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    sys.exit(1 if failed else 0)
