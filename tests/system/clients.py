# SPDX-License-Identifier: MIT
"""The genuine clients of owserver, one class for each, all with the same calls.

    client = clients.Shell(scene, server)
    client.dir("/")                      # a sorted list of paths, no slash behind directories
    client.read("/28.X/temperature")     # bytes as the client gives them
    client.write("/28.X/templow", b"12")
    client.present("/28.X")              # True or False

What the server refuses raises Refused; its number is that of the owserver protocol where the
client tells it. Ways to ask that not every client has are options of read() and dir(), and
`can` names those that it has: scale="F", format="fic", size=4, offset=2. With "parts" it has
write_at(path, value, offset).
"""

import asyncio
import fcntl
import importlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse

import owsdtest

SCALES, FORMATS = "CFKR", ("f.i", "fi", "f.i.c", "f.ic", "fi.c", "fic")
HERE = pathlib.Path(__file__).resolve().parent
PIP = 1800  # seconds


class Refused(Exception):
    """The client says that it cannot be had; number: of the protocol, None where it says not why."""

    def __init__(self, number=None, why="it is absent"):
        super().__init__(f"{number}: {why}")
        self.number = number


def _program(name):
    return shutil.which(name) or owsdtest.skip(f"{name} is not installed")


def _unhurried(ask):
    """ow-shell, libownet and owhttpd give a server up that was silent for two seconds. On a busy
    machine the best one is so now and then, and is asked again; one that always is gets nowhere."""
    for _ in range(4):
        begun = time.monotonic()
        try:
            return ask()
        except Refused:
            if time.monotonic() - begun < 2:
                raise
    return ask()


def _names(entries):
    return sorted(entry.rstrip("/") for entry in entries if entry)


class Client:
    can = frozenset()
    remote = True  # its /settings, /system and /statistics are the server's and not its own
    tells = True  # of a write that failed

    def __init__(self, scene, server):
        self.scene, self.server = scene, server

    def close(self):
        pass


# --- ow-shell -------------------------------------------------------------------------------------
class Shell(Client):
    """owdir, owread, owwrite, owpresent, owget: a process and a connection for each request."""

    can = frozenset(("scale", "format", "size", "present", "get"))

    def _ask(self, name, *words):
        return subprocess.run([_program(name), "-s", self.server.target, *words], check=False,
                              timeout=owsdtest.PATIENCE, capture_output=True)

    def _run(self, name, *words):
        def ask():
            done = self._ask(name, *words)
            if done.returncode or done.stderr:
                raise Refused(None, f"{name} {words}: {done}")
            return done.stdout
        return _unhurried(ask)

    @staticmethod
    def _options(scale=None, format=None, size=None, offset=None):
        options = [f"-{scale}"] if scale else []
        options += [f"--format={format}"] if format else []
        options += [f"--size={size}"] if size is not None else []
        return options + ([f"--start={offset}"] if offset is not None else [])

    def dir(self, path, **how):
        return _names(self._run("owdir", *self._options(**how), path).decode().split("\n"))

    def read(self, path, **how):
        return self._run("owread", *self._options(**how), path)

    def write(self, path, value):
        self._run("owwrite", "--", path, value)

    def present(self, path):
        def ask():
            done = self._ask("owpresent", path)
            assert (done.returncode, done.stdout) in ((0, b"1"), (1, b"0")), done
            if done.returncode:
                raise Refused
            return True
        try:
            return _unhurried(ask)
        except Refused:
            return False

    def get(self, path):
        return self._run("owget", path)


# --- libownet -------------------------------------------------------------------------------------
class Libownet(Client):
    """The C library, in the program ownet: one persistent connection."""

    can = frozenset(("scale", "format", "size", "present", "parts"))

    def __init__(self, scene, server):
        super().__init__(scene, server)
        program = owsdtest.BUILD / "system/ownet"  # ends with 77 where libownet-dev was not installed
        owsdtest.need(program)
        self.process = subprocess.Popen([str(program), server.target], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        try:
            self._how()
        except (Refused, OSError):
            if self.process.wait(owsdtest.PATIENCE) == 77:
                owsdtest.skip("no libownet-dev when this was built")
            raise

    def close(self):
        self.process.communicate(timeout=owsdtest.PATIENCE)

    def _ask(self, *words):
        def ask():
            self.process.stdin.write(" ".join(str(w) for w in words) + "\n")
            self.process.stdin.flush()
            word, _, rest = self.process.stdout.readline().rstrip("\n").partition(" ")
            if word != "ok":
                raise Refused(int(rest) if rest else None, f"libownet {words}")
            return b"" if rest == "-" else bytes.fromhex(rest)
        return _unhurried(ask)

    def _how(self, scale="C", format="f.i"):
        self._ask("scale", scale)
        self._ask("format", format)

    def dir(self, path, **how):
        self._how(**how)
        return _names(self._ask("dir", path).decode().rstrip("\0").split(","))

    def read(self, path, size=None, offset=0, **how):
        self._how(**how)
        return self._ask("read", path) if size is None else self._ask("lread", size, offset, path)

    def write(self, path, value):
        self._ask("put", value.hex() or "-", path)

    def write_at(self, path, value, offset):
        self._ask("lwrite", offset, value.hex() or "-", path)

    def present(self, path):
        try:
            self._ask("present", path)
            return True
        except Refused:
            return False


# --- Python ---------------------------------------------------------------------------------------
def python_client(name, wanted=HERE / "requirements.txt", folder="clients"):
    """A package of requirements.txt, out of the user's cache or, once, from the package index."""
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    try:
        base.mkdir(parents=True, exist_ok=True)
    except OSError:
        base = owsdtest.BUILD
    text = wanted.read_text()
    packages = base / f"python{sys.version_info.major}.{sys.version_info.minor}-{folder}"
    with open(base / "python-clients.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (packages / wanted.name).exists() or \
                (packages / wanted.name).read_text() != text:
            _install(wanted, packages)
    if str(packages) not in sys.path:
        sys.path.insert(0, str(packages))
    return importlib.import_module(name)


def _pip(venv, made, what, *words):
    """pip install WORDS with a new venv; where that fails, made is removed again and the test is
    skipped. A package without a wheel is compiled, which takes minutes on a busy machine."""
    for command in ([sys.executable, "-m", "venv", venv],
                    [f"{venv}/bin/python", "-m", "pip", "--quiet", "--disable-pip-version-check",
                     "--retries", "1", "install", *words]):
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              start_new_session=True) as pip:
            try:
                last = (pip.communicate(timeout=PIP)[0].strip().splitlines() or ["?"])[-1]
            except subprocess.TimeoutExpired:
                os.killpg(pip.pid, signal.SIGKILL)  # its compilers, too
                last = f"pip takes longer than {PIP} s"
        if pip.returncode:
            shutil.rmtree(made, ignore_errors=True)
            owsdtest.skip(f"not cached and cannot be had: {what}: {last[-200:]}")


def _install(wanted, packages):
    with tempfile.TemporaryDirectory() as where:
        fresh = pathlib.Path(tempfile.mkdtemp(dir=packages.parent))
        _pip(where, fresh, wanted.name, "--timeout", "10", "--require-hashes", "--no-deps",
             "--no-compile", "--only-binary", ":all:", "--target", str(fresh), "-r", str(wanted))
        shutil.copy(wanted, fresh)
        shutil.rmtree(packages, ignore_errors=True)
        fresh.rename(packages)


def environment(name, wanted):
    """The folder of the programs of these packages, in a venv of the user's cache; made once, from
    the package index."""
    base = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "owsd"
    try:
        base.mkdir(parents=True, exist_ok=True)
    except OSError:
        base = owsdtest.BUILD
    place, mark = base / name, "\n".join(wanted)
    with open(base / f"{name}.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "wanted").exists() or (place / "wanted").read_text() != mark:
            shutil.rmtree(place, ignore_errors=True)
            _pip(place, place, wanted[0], *wanted)
            (place / "wanted").write_text(mark)
    return place / "bin"


class Pyownet(Client):
    """pyownet, a connection for each request; PyownetPersistent keeps one."""

    can = frozenset(("scale", "format", "size", "present", "number"))
    persistent = False

    def __init__(self, scene, server):
        super().__init__(scene, server)
        self.protocol = python_client("pyownet.protocol")
        self.protocol._SCK_TIMEOUT = owsdtest.PATIENCE  # of 2 s; test_serve_frames.py looks at that
        self.proxy = self._proxy(0)

    def _proxy(self, flags):
        return self.protocol.proxy(self.server.host, self.server.port, flags=flags,
                                   persistent=self.persistent)

    def close(self):
        if self.persistent:
            self.proxy.close_connection()

    def _as(self, scale="C", format="f.i"):
        flags = SCALES.index(scale) << 16 | FORMATS.index(format) << 24
        return self._proxy(flags) if flags else self.proxy

    def _ask(self, call, *words, **how):
        try:
            return call(*words, **how)
        except self.protocol.OwnetError as error:
            assert error.strerror and "Unknown" not in error.strerror, error
            raise Refused(-error.errno, error.strerror) from None

    def dir(self, path, **how):
        return _names(self._ask(self._as(**how).dir, path, bus=True))

    def read(self, path, size=65536, offset=0, **how):
        return self._ask(self._as(**how).read, path, size=size, offset=offset)

    def write(self, path, value):
        self._ask(self.proxy.write, path, value)

    def present(self, path):
        return self._ask(self.proxy.present, path)


class PyownetPersistent(Pyownet):
    persistent = True


class AioOwnet(Client):
    """aio-ownet, what Home Assistant uses."""

    can = frozenset(("size", "number"))

    def __init__(self, scene, server):
        super().__init__(scene, server)
        if sys.version_info < (3, 11):
            owsdtest.skip("aio-ownet wants Python 3.11")
        self.module = python_client("aio_ownet.proxy")
        self.exceptions = python_client("aio_ownet.exceptions")
        self.proxy = self.module.OWServerStatelessProxy(server.host, server.port)
        asyncio.run(self.proxy.validate())

    def _ask(self, call, *words, **how):
        try:
            return asyncio.run(call(*words, **how))
        except self.exceptions.OWServerReturnError as error:
            assert "Unknown" not in str(error), error
            raise Refused(-error.args[0], str(error)) from None

    def dir(self, path):
        return _names(self._ask(self.proxy.dir, path, bus=True))

    def read(self, path, **how):
        return self._ask(self.proxy.read, path, **how)

    def write(self, path, value):
        self._ask(self.proxy.write, path, value)


class Asyncowfs(Client):
    """asyncowfs of MoaT, which EVOK of Unipi uses: one connection, and answers of at most 9,999
    bytes."""

    can = frozenset(("number",))

    def __init__(self, scene, server):
        super().__init__(scene, server)
        if sys.version_info < (3, 11):
            owsdtest.skip("asyncowfs is pinned with anyio for Python 3.11")
        self.module, self.errors = python_client("asyncowfs"), python_client("asyncowfs.error")
        self.events, messages = python_client("asyncowfs.event"), python_client("asyncowfs.protocol")
        for message in (messages.AttrGetMsg, messages.AttrSetMsg, messages.DirMsg):
            message.timeout = owsdtest.PATIENCE
        # it asks for everything uncached, and what is that of owserver's mock is chance
        messages.OWFlag.uncached = 0

    def _ask(self, call):
        async def ask():
            async with self.module.OWFS(initial_scan=False) as ow:
                return await call(await ow.add_server(self.server.host, self.server.port))
        try:
            return asyncio.run(ask())
        except* self.errors.OWFSReplyError as group:
            error = group
            while isinstance(error, BaseExceptionGroup):
                error = error.exceptions[0]
        raise Refused(-abs(error.err), repr(error))

    def dir(self, path):
        below = "" if path == "/" else path
        names = self._ask(lambda server: server.dir(*path.strip("/").split("/")))
        # it asks for ids with their checksum
        return _names(f"{below}/" + re.sub(r"^(..\..{12})\...$", r"\1", name) for name in names)

    def read(self, path):
        return self._ask(lambda server: server.attr_get(*path.strip("/").split("/")))

    def write(self, path, value):
        self._ask(lambda server: server.attr_set(*path.strip("/").split("/"), value=value))

    def locate(self):
        """All devices, and what of each its fields of /structure name, as EVOK's scan does it."""
        async def scan(server):
            await server.scan_now(polling=False)
            found = {}
            for device in server.service._devices.values():
                if device.bus is not None:
                    found[device.id] = (await device.get_type(),
                                        sorted("/".join(field) for field in device.fields))
            return found
        return self._ask(scan)


# --- The daemons ----------------------------------------------------------------------------------
class Owhttpd(Client):
    """owhttpd as a client of the server: its pages of plain text. It tells of no failed write."""

    remote = tells = False

    def __init__(self, scene, server):
        super().__init__(scene, server)
        self.port = owsdtest.free_port()
        self.daemon = scene.start([_program("owhttpd"), "-s", server.target, "-p",
                                   f"127.0.0.1:{self.port}", "--foreground"])
        self.daemon.last_signal = 9
        owsdtest.until(lambda: self._page("/text/system/process/pid"), 20, "owhttpd answers")

    def _page(self, path, name=b"", attempts=20):
        """The body, which begins with name; None when nobody listens. owhttpd closes a connection a
        little later than it ends, and then now and then another one, or a wrong page comes: so
        there is a pause before each request, and it may be made again."""
        time.sleep(0.02)  # pause
        try:
            with socket.create_connection(("127.0.0.1", self.port), timeout=20) as s:
                s.sendall(f"GET {path} HTTP/1.0\r\nHost: localhost\r\n\r\n".encode())
                answer = b"".join(iter(lambda: s.recv(65536), b""))
        except ConnectionRefusedError:
            return None
        except OSError:
            answer = b""
        head, _, body = answer.partition(b"\r\n\r\n")
        found = b" 200 " in head.split(b"\r\n")[0]
        if attempts > 1 and (not body or found and not body.startswith(name)):
            return self._page(path, name, attempts - 1)
        if not found or not body.startswith(name):
            raise Refused(None, f"owhttpd {path}: {answer}")
        return body

    def dir(self, path):
        below = "" if path == "/" else path
        listed = None

        def twice():
            nonlocal listed
            before, page = listed, _unhurried(lambda: self._page(f"/text{path}"))
            listed = _names(f"{below}/{line.split()[0]}" for line in
                            page.decode("latin-1").splitlines() if line.strip())
            return listed == before  # it is this one's page then
        owsdtest.until(twice, 20, f"owhttpd says the same twice of {path}", step=0)
        return listed

    def read(self, path):
        name = path.rpartition("/")[2].encode() + b" "
        page = _unhurried(lambda: self._page(f"/text{path}", name))
        return page[len(name):].rstrip(b"\r\n")

    def write(self, path, value):
        name = path.rpartition("/")[2]
        _unhurried(lambda: self._page(f"{path}?" + urllib.parse.urlencode({name: value.decode()})))


class Owfs(Client):
    """owfs as a client of the server: a file system."""

    can = frozenset(("number", "parts"))
    remote = False

    def __init__(self, scene, server):
        super().__init__(scene, server)
        _program("owfs")
        try:
            os.close(os.open("/dev/fuse", os.O_RDWR))
        except OSError as error:
            owsdtest.skip(f"/dev/fuse: {error.strerror}")
        self.mount = scene.path / f"owfs{server.port}"
        self.mount.mkdir()
        self.daemon = scene.start([_program("owfs"), "-s", server.target, "--foreground",
                                   "-m", self.mount])
        owsdtest.until(lambda: os.path.ismount(self.mount) or not self.daemon.running(), 20,
                       "owfs is mounted")
        if not self.daemon.running():
            owsdtest.skip("owfs may not mount here")

    def close(self):
        for command in (["fusermount", "-u", self.mount], ["umount", "-l", self.mount]):
            try:
                if subprocess.run(command, capture_output=True, timeout=10,
                                  check=False).returncode == 0:
                    return
            except FileNotFoundError:
                pass

    def _file(self, path):
        return self.mount / path.lstrip("/")

    def dir(self, path):
        below = "" if path == "/" else path
        try:
            return _names(f"{below}/{name}" for name in os.listdir(self._file(path)))
        except OSError as error:
            raise Refused(-error.errno, str(error)) from None

    def read(self, path):
        try:
            return self._file(path).read_bytes()
        except OSError as error:
            raise Refused(-error.errno, str(error)) from None

    def write(self, path, value):
        try:
            with open(self._file(path), "wb", buffering=0) as file:
                file.write(value)
        except OSError as error:
            raise Refused(-error.errno, str(error)) from None

    def write_at(self, path, value, offset):
        """In the way of dd: a write for each 32 bytes."""
        try:
            with open(self._file(path), "r+b", buffering=0) as file:
                file.seek(offset)
                for at in range(0, len(value), 32):
                    assert file.write(value[at:at + 32]) == len(value[at:at + 32])
        except OSError as error:
            raise Refused(-error.errno, str(error)) from None


# --- Ours -----------------------------------------------------------------------------------------
class Owsctl(Client):
    """owsctl -t SERVER: the bus that owsd itself uses towards an owserver."""

    def _run(self, *words):
        done = self.scene.owsctl(None, "-t", self.server.target, *words)
        if done.returncode:
            raise Refused(None, done.stderr)
        return done.stdout

    def dir(self, path):
        return sorted(json.loads(self._run("--json", "dir", path)))

    def read(self, path):
        return self._run("read", path)[:-1].encode()

    def write(self, path, value):
        self._run("write", path, value.decode())


ALL = (Shell, Libownet, Pyownet, PyownetPersistent, AioOwnet, Asyncowfs, Owhttpd, Owfs, Owsctl)
