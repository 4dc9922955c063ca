#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An owserver that does as it is told, and misbehaves when told so.

In a test:

    import peer

    with peer.Peer({"/28.AABBCCDDEEFF/temperature": "     21.5"}) as server:
        daemon = scene.owsd(owsdtest.rio(server.target, [...]))
        server.mode = "hang"                  # from now on
        server.plan.append("reset")           # or: the next request only, before mode counts
        server.ways[PATH] = "alive"           # or: requests for this path, while it stands there
        server["/28.AABBCCDDEEFF/temperature"] = "22"
        assert server.writes == [("/29.AABBCCDDEEFF/PIO.0", b"1")]
        server.down(); server.up()            # stop listening, begin again on the same port

As a program: peer.py [--host HOST] [--port PORT] [PATH=VALUE ...]. It prints its target, then
takes commands on standard input, one a line: a mode, `next MODE`, `set PATH VALUE`,
`alarm DEVICE ...`, `down`, `up`, `requests` (prints how many), `quit` (so does the end of input).

Modes. Greetings (NOP, and questions below /bus.N and /settings/timeout) are not counted, and they
are answered properly in all modes but accept_close and dead.
  normal         answers
  refuse         answers, refuses persistence and closes      fragments  answers byte by byte
  slow S         answers after S seconds, a keep-alive every 0.2 s before
  late S         answers after S seconds of silence
  alive          sends keep-alives for ever, no answer         hang       sends nothing, for ever
  flood          the same, as fast as it can
  kill           sends half of an answer, then closes          stall      sends half, then nothing
  close          closes instead of answering                   reset      resets the connection
  close_after    answers properly, then closes
  garbage        sends text that is no frame                   trailing   more bytes after an answer
  negative       payload -5        huge    payload 2 GB        version    a version that is none
  long           more data than were asked for                 wrong      says more than it sends
  less           says less than it sends
  endless        begins a frame of 200 000 bytes and sends bytes for ever
  accept_close   closes each connection at once                dead       accepts, never says a word

Devices are the first components of the paths; `alarms` is the set of those that /alarm lists.
Those in `pulled` are away, and read all the same, as owserver reads ones where other devices are.
Paths in `readonly` refuse writing, and `refusals` maps a path to the code it is answered with.
"""

import argparse
import collections
import socket
import struct
import sys
import threading
import time

import owsdtest

NOP, READ, WRITE, DIR, PRESENT, DIRALL = 1, 2, 3, 4, 6, 7
PERSIST = 0x4
SERVERMESSAGE, TOKEN = 0x10000, 16
KEEP_ALIVE = struct.pack(">6i", 0, -1, 0, 0, 0, 0)
MODES = {"normal", "refuse", "fragments", "slow", "late", "alive", "hang", "kill", "stall", "close",
         "flood", "reset", "close_after", "garbage", "trailing", "negative", "huge", "version", "long",
         "wrong", "less", "endless", "accept_close", "dead"}
CLOSES = {"refuse", "kill", "close", "reset", "close_after"}

Request = collections.namedtuple("Request", "kind path data flags size")


class Gone(Exception):
    """The client went, or the peer is to stop."""


class Peer:
    def __init__(self, values=None, host="127.0.0.1", port=0):
        self.values = {p: _bytes(v) for p, v in (values or {}).items()}
        # not one of the kernel's choice: it might give that to a client while we are down
        self.host, self.port = host, port or owsdtest.free_port()
        self.alarms, self.pulled, self.readonly, self.refusals = set(), set(), set(), {}
        self.plan, self.ways = collections.deque(), {}
        self.requests, self.connections = [], 0
        self._mode = "normal"
        self._lock = threading.Lock()
        self._listener = None
        self._open = set()
        self._stop = threading.Event()
        self.up()

    # --- what a test uses ---------------------------------------------------------------------
    @property
    def target(self):
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    @property
    def mode(self):
        return self._mode

    @mode.setter
    def mode(self, mode):
        assert mode.split()[0] in MODES, mode
        self._mode = mode

    @property
    def writes(self):
        return [(r.path, r.data) for r in list(self.requests) if r.kind == WRITE]

    def reads(self, path):
        return sum(r.kind == READ and r.path == path for r in list(self.requests))

    def __setitem__(self, path, value):
        self.values[path] = _bytes(value)

    def __getitem__(self, path):
        return self.values[path].decode("latin-1")

    def up(self):
        """Listen (again)."""
        if self._listener:
            return
        self._stop = threading.Event()
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listener = socket.socket(family)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((self.host, self.port))
        listener.listen(16)
        self.port = listener.getsockname()[1]
        self._listener = listener
        threading.Thread(target=self._accept, args=(listener, self._stop), daemon=True).start()

    def down(self):
        """Stop listening and drop every connection, as a server does that was killed."""
        if not self._listener:
            return
        self._stop.set()
        _shut(self._listener)
        self._listener = None
        with self._lock:
            for s in self._open:
                _shut(s, close=False)
            self._open.clear()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.down()

    # --- connections --------------------------------------------------------------------------
    def _accept(self, listener, stop):
        while not stop.is_set():
            try:
                s, _ = listener.accept()
            except OSError:
                return
            self.connections += 1
            if self._mode == "accept_close":
                s.close()
                continue
            with self._lock:
                if stop.is_set():
                    s.close()
                    return
                self._open.add(s)
            threading.Thread(target=self._serve, args=(s, stop), daemon=True).start()

    def _serve(self, s, stop):
        s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            while self._one(s, stop):
                pass
        except (Gone, OSError, struct.error):
            pass
        finally:
            with self._lock:
                self._open.discard(s)
            s.close()

    def _one(self, s, stop):
        version, length, kind, flags, size, _ = struct.unpack(">6i", _exactly(s, 24))
        if not 0 <= length <= 100050:
            return False
        path, _, data = _exactly(s, length).partition(b"\0")
        if version & SERVERMESSAGE:  # the servers that it came through
            _exactly(s, TOKEN * (version & 0xffff))
        request = Request(kind, path.decode("latin-1"), data, flags, size)
        mode = self._mode
        greeting = kind == NOP or request.path.startswith(("/bus.", "/settings/timeout/"))
        if not greeting:
            self.requests.append(request)
            mode = self.ways.get(request.path, mode)
            try:
                mode = self.plan.popleft()
            except IndexError:
                pass
        elif mode != "dead":
            mode = "normal"
        return self._act(s, stop, *mode.split(), request=request)

    def _act(self, s, stop, mode, seconds="0", request=None):
        reply = self._answer(request)
        if mode in ("hang", "dead"):
            self._until_gone(s, stop, b"", 3600)
        elif mode == "alive":
            self._until_gone(s, stop, KEEP_ALIVE, 3600)
        elif mode == "flood":
            while not stop.is_set():
                s.sendall(KEEP_ALIVE * 1000)
        elif mode in ("slow", "late"):
            self._until_gone(s, stop, KEEP_ALIVE if mode == "slow" else b"", float(seconds))
        elif mode == "endless":
            s.sendall(struct.pack(">6i", 0, 200000, 0, request.flags, 200000, 0))
            self._until_gone(s, stop, b"x" * 100, 3600, 0.01)
        elif mode == "reset":
            s.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        elif mode in ("kill", "stall"):
            s.sendall(reply[:len(reply) // 2])
            if mode == "stall":
                self._until_gone(s, stop, b"", 3600)
        words = list(struct.unpack(">6i", reply[:24]))
        if mode == "refuse":
            words[3] &= ~PERSIST
        elif mode == "negative":
            words[1] = -5
        elif mode == "huge":
            words[1] = 0x7fffffff
        elif mode == "version":
            words[0] = 0x20000
        elif mode == "wrong":
            words[2] = words[1] + 100
        elif mode == "less":
            words[2] = max(words[1] - 2, 0)
        elif mode == "long":
            words[1] = request.size + 1000
            reply += b"x" * (words[1] + 24 - len(reply))
        reply = struct.pack(">6i", *words) + reply[24:]
        if mode == "garbage":
            reply = b"HTTP/1.1 400 Bad Request\r\nServer: none of yours\r\n\r\n"
        elif mode == "trailing":
            reply += b"abc"
        if mode == "fragments":
            for i in range(len(reply)):
                s.sendall(reply[i:i + 1])
        elif mode not in ("kill", "close", "reset"):
            s.sendall(reply)
        return mode not in CLOSES

    @staticmethod
    def _until_gone(s, stop, what, seconds, every=0.2):
        """Send what again and again, as often as it fits into the time however late we are; raises
        Gone when the client went."""
        for _ in range(round(seconds / every)):
            s.settimeout(every)
            try:
                if not s.recv(1, socket.MSG_PEEK):
                    raise Gone
                time.sleep(every)  # a peer that is slow
            except socket.timeout:
                pass
            if stop.is_set():
                raise Gone
            s.settimeout(60)
            s.sendall(what)
        s.settimeout(None)

    # --- answers ------------------------------------------------------------------------------
    def _answer(self, r):
        code, data, size = 0, b"", 0
        device = "/" + r.path.replace("/alarm/", "/", 1).strip("/").split("/")[0]
        path = r.path.replace("/alarm/", "/", 1) if r.path.startswith("/alarm/") else r.path
        if path in self.refusals and r.kind != NOP:
            code = self.refusals[path]
        elif r.kind == READ:
            if path not in self.values:
                code = -1
            else:
                data = self.values[path][:r.size]
                code = size = len(data)
        elif r.kind == WRITE:
            if path not in self.values:
                code = -1
            elif path in self.readonly:
                code = -95
            else:
                self.values[path], size = r.data, len(r.data)
        elif r.kind == PRESENT:
            if device in self.pulled or not any(p.startswith(device + "/") for p in self.values):
                code = -1
            else:
                data = b"\x28" + bytes(7)
        elif r.kind == DIRALL:
            names = self._list(r.path)
            if names is None:
                code = -1
            else:
                data = ",".join(names).encode("latin-1") + b"\0"
                size = len(data) - 1
        elif r.kind != NOP:
            code = -42
        return struct.pack(">6i", 0, len(data), code, r.flags, size, 0) + data

    def _list(self, path):
        devices = sorted({"/" + p.split("/")[1] for p in self.values})
        if path in ("/", ""):
            return devices
        if path.rstrip("/") == "/alarm":
            return ["/alarm/" + a.strip("/") for a in sorted(self.alarms)]
        below = path.rstrip("/") + "/"
        names = sorted({below + p[len(below):].split("/")[0]
                        for p in self.values if p.startswith(below)})
        return names or None


def _bytes(value):
    return value if isinstance(value, bytes) else str(value).encode("latin-1")


def _shut(s, close=True):
    try:
        s.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    if close:
        s.close()


def _exactly(s, n):
    data = b""
    while len(data) < n:
        more = s.recv(n - len(data))
        if not more:
            raise Gone
        data += more
    return data


def obey(server, line):
    """One command of standard input. False: quit."""
    word, _, rest = line.strip().partition(" ")
    if word == "quit":
        return False
    if word == "next" and rest.split() and rest.split()[0] in MODES:
        server.plan.append(rest)
    elif word == "set" and " " in rest:
        path, _, value = rest.partition(" ")
        server[path] = value
    elif word == "alarm":
        server.alarms = set(rest.split())
    elif word in ("down", "up"):
        getattr(server, word)()
    elif word == "requests":
        print(len(server.requests), flush=True)
    elif word in MODES:
        server.mode = line.strip()
    elif word:
        print(f"? {line.strip()}", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("values", nargs="*", metavar="PATH=VALUE")
    options = parser.parse_args()
    values = dict(v.partition("=")[::2] for v in options.values)
    with Peer(values, options.host, options.port) as server:
        print(server.target, flush=True)
        for line in sys.stdin:
            if not obey(server, line):
                break


if __name__ == "__main__":
    main()
