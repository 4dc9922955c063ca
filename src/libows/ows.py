# SPDX-License-Identifier: MIT
"""Read and set the signals of owsd from Python: one file, nothing to build.

    import ows

    with ows.Ows() as signals:                    # instance "OWS"
        room = signals.get("room1")
        if room.good:
            print(room.value, "measured", room.age, "s ago")

    with ows.Ows(control=True) as signals:        # needs the right to command
        signals.set("relay", True)

Names, attributes ("room1_Age") and the meaning of every field are those of libows(3). A reader maps
the image alone, and a read takes no system call and no lock; each is verified by its check word. A
program that commands is connected to owsd until close(), and has a memory of its own for that. An
Ows object belongs to one thread at a time, and after a fork only to the parent.

What was is read by History, which needs libows-history(3); all else needs this file alone.

From a shell:  python3 ows.py [-n INSTANCE] [NAME [VALUE]]
"""

import collections
import ctypes
import errno
import fcntl
import math
import mmap
import os
import platform
import pwd
import select
import socket
import stat
import struct
import sys
import time

MAJOR = 2
IMAGE_MAGIC, GIVER_MAGIC, HELLO_MAGIC, WELCOME_MAGIC = 0x4953574F, 0x4753574F, 0x4853574F, 0x5753574F
BUILDING, LIVE, RETIRED, STOPPED = range(4)
BOOL, BYTE, SHORT, LONG, WORD, DWORD, FLOAT, DOUBLE, LARGE, STRING = 1, 2, 3, 4, 5, 6, 7, 8, 10, 12
RANGES = {
    BOOL: (0, 1), BYTE: (0, 255), SHORT: (-2**15, 2**15 - 1), LONG: (-2**31, 2**31 - 1),
    WORD: (0, 2**16 - 1), DWORD: (0, 2**32 - 1), LARGE: (-2**63, 2**63 - 1),
}
TYPE_NAMES = {BOOL: "bool", BYTE: "byte", SHORT: "short", LONG: "long", WORD: "word",
              DWORD: "dword", FLOAT: "float", DOUBLE: "double", LARGE: "large", STRING: "string"}
Q_NO_PROPERTY, Q_TYPE, Q_ACCESS = 0x04, 0x05, 0x06
Q_STALE, Q_TARGET, Q_GOOD = 0x14, 0x18, 0xC0
WHOLE_TRIES = 64
OUTPUT, FRESH, ALARM, NO_SET = 1, 2, 4, 8
CONFIRM = 16  # of an info
READ_ENABLE, WRITE_ENABLE, IN_WORK = 1, 2, 4
ALARM_POLLED, ALARM_STANDS, LIMITS, ALARM_UNARMED = 16, 32, 64, 128

# name, short form, type, readable, writable; _Value has the type of its signal
ATTRIBUTES = [
    ("_Value", None, None, True, True),
    ("_DGNRESET", None, BOOL, False, True),
    ("_TRANSACTIONS", None, LARGE, True, False),
    ("_ReadEnable", "_RE", BOOL, True, True),
    ("_WriteEnable", "_WE", BOOL, True, True),
    ("_WriteOneShot", "_WOS", BOOL, False, True),
    ("_Alarm", None, BOOL, True, False),
    ("_PerFactor", None, LARGE, True, False),
    ("_PerCount", None, LARGE, True, False),
    ("_PerMax", None, LARGE, True, False),
    ("_PendCount", None, LARGE, True, False),
    ("_PendLast", None, LARGE, True, False),
    ("_PendMax", None, LARGE, True, False),
    ("_Period", None, DOUBLE, True, False),
    ("_Age", None, DOUBLE, True, False),
    ("_AgeMax", None, DOUBLE, True, False),
    ("_Raw", None, DOUBLE, True, False),
]
ATTRIBUTE = {a[0]: a for a in ATTRIBUTES}
DRIVER = {"_DGNRESET": (BOOL, False, True), "_TRANSACTIONS": (LARGE, True, False),
          "_RECONNECTS": (LARGE, True, False)}

# One slot: the sample's 48 bytes and the attributes' 80
SAMPLE = struct.Struct("<8sqqiBBBBIIII")
ATTRS = struct.Struct("<Qqqq8sIIIIIIIBBBB4xI")
Attrs = collections.namedtuple("Attrs", "transactions update_ns age_max_ns commanded raw per_base "
                               "per_max pend_base pend_last pend_max alarms flags limit_state "
                               "limit_condition shelved spare check")
Header = collections.namedtuple(
    "Header", "magic major minor size generation state pid start_id area_off area_count "
    "served_off start_ns start_wall_ns period_ns")
HEADER = struct.Struct("<IHHIIIiIIIIqqq")
# The directory of areas, and the least size of an entry of each kind that is read here
Area = collections.namedtuple("Area", "off size count", defaults=[0, 0, 0])
AREA = struct.Struct("<IIII")
RECORDS, INFOS, TARGETS, POOL, TEXTS, ORIGINS, GIVERS = 1, 2, 4, 6, 7, 8, 9
SHELVES, ALARMS, COMMANDS, CHANGES, DEVICES = 10, 11, 12, 13, 14
ENTRY_SIZES = {RECORDS: 320, INFOS: 192, TARGETS: 128, POOL: 1, TEXTS: 1, ORIGINS: 104,
               GIVERS: 120, SHELVES: 184, ALARMS: 200, COMMANDS: 200, CHANGES: 8, DEVICES: 128}
ORIGIN_ENTRY = struct.Struct("<IIq80s4xI")
GIVER_ENTRY = struct.Struct("<IIq80sIII8xI")
GIVER_CONNECTED, GIVER_MAY_SET, GIVER_LATE = 1, 2, 4
JOURNAL_ENTRY = struct.Struct("<IIq8s8sBBBBI64s80sI8xI")
DEVICE_ENTRY = struct.Struct("<IIIIQQQQqI4x48s12xI")
SHELF_ENTRY = struct.Struct("<IIqq80s64s12xI")
WHO = struct.Struct("<IIi4x32s32s")
# The memory of a giver. Words of a slot, from its beginning, and offsets of words in the header
GiverHeader = collections.namedtuple(
    "GiverHeader", "magic major minor size generation start_id serial slot_off slot_size slot_count "
    "text_off text_cap place_off dirty_off dirty_words person_off shelf_off")
GIVER_HEADER = struct.Struct("<IHHIIIIIIIIIIIIII")
GIVER_STATE, GIVER_MARKED, GIVER_BEAT, GIVER_PERIOD, GIVER_GOODBYE, GIVER_WAITS = \
    64, 128, 132, 136, 140, 144
GIVER_HEADER_SIZE, COMMAND_SLOT_SIZE, SHELF_SIZE = 256, 64, 96
(SLOT_STAMP, SLOT_PERSON, SLOT_READ_ENABLE, SLOT_WRITE_ENABLE, SLOT_ONE_SHOT, SLOT_DGN_RESET,
 SLOT_ACKNOWLEDGED) = range(2, 9)
SLOT_TAKEN, SLOT_APPLIED, SLOT_ERR, SLOT_ALLOWED = range(12, 16)
PERSONS, NAME_SIZE, TEXT_SIZE = 16, 32, 64
# The connection
HELLO = struct.Struct("<IHHI4x16s32s64x")
HELLO_COMMAND = 1
BEAT_MOST_MS = 3600000  # the longest that beat() promises
Welcome = collections.namedtuple("Welcome", "magic major minor err generation start_id serial size "
                                 "token")
WELCOME = struct.Struct("<IHHiIIII4x16s16x")
F_GET_SEALS, SEALS = 1034, 7
SERVICE = "/run/owsd"
STATE_OFF, NEWS_OFF, ALARM_HEAD_OFF, COMMAND_HEAD_OFF = 16, 128, 132, 136
CHANGE_HEAD_OFF = 140
# How often the names of segments are looked at while owsd's heart stands still
ORPHAN_LOOK_NS = 1_000_000_000


class Stale(OSError):
    """owsd was restarted or reloaded, or (where something is set) has ended or hangs: reopen()."""

    def __init__(self):
        super().__init__(errno.ESTALE, "owsd has ended, or was restarted or reloaded")


class Value(collections.namedtuple("Value", "value type quality detail target err measured_ns "
                                   "tried_ns age count applied data", defaults=[None])):
    """A value with what belongs to it; age in seconds, before the first value since the start.
    data: the bytes of a string as they are, of which value has U+FFFD where they are not UTF-8;
    None for all other types."""

    @property
    def good(self):
        return self.quality & 0xC0 == 0xC0


ALARM_KINDS = ["none", "device", "power-on reset", "high high", "high", "low", "low low", "stale",
               "bad", "not as commanded"]
LIMIT_STATES = ["normal", "unacknowledged", "acknowledged", "returned to normal unacknowledged"]
ALARM_EVENTS = ["unknown", "raised", "returned", "acknowledged", "shelved", "unshelved",
                "failed"]
REASONS = ["none", "set", "returned", "InitValue", "SafeValue", "last"]
# Who did something: uid and pid are the kernel's word, name and person (for whom) the program's
# claims; owsd itself has serial 0
By = collections.namedtuple("By", "serial uid pid name person")
# before and after: None where there is no value; kind and event: words; text: what the latch
# showed, or why the alarm was shelved
AlarmEntry = collections.namedtuple("AlarmEntry", "number name occurred_ns before after kind event "
                                    "quality text who")
# reason: a word; more: commands to this signal that were not entered before it; the
# value of a string may be cut
CommandEntry = collections.namedtuple("CommandEntry", "number name taken_ns value reason quality "
                                      "more who")

# Who gave the command in force, when owsd took it, why (a word), and whether this object gave it
Origin = collections.namedtuple("Origin", "who taken_ns reason own")
# A connected program; period_ms: promised longest time between two beats, 0: none; commands: taken
Giver = collections.namedtuple("Giver", "who joined_ns period_ms commands refused may_set late")

# How the alarms of a signal stand: occurrences of the device's alarm since owsd started, whether it
# stands, whether the item is read as an input for want of an alarm search; limit alarms in words;
# whether the device's alarm cannot be armed, read or reset; None, or the Shelf of a limit alarm that is shelved
AlarmState = collections.namedtuple("AlarmState", "occurrences stands polled limits limit_state "
                                    "limit_kind unarmed shelf")
Shelf = collections.namedtuple("Shelf", "since_ns until_ns who why")

# A way to devices; ways to one wire have the same group, all but one of them suspended; moves:
# signals that came from another target. The index is what Value.target says
Target = collections.namedtuple("Target", "index name state reconnects group moves")
TARGET = struct.Struct("<104sIIII8x")

# A device that signals name by its ROM id. identity: which chip it is by its behaviour; power:
# "parasite", "external"; both None: not known. target: the index of the one that answered last,
# None: none yet. Counted since owsd's start: answers good and bad, errors of requests, retries,
# microseconds of the wire. ok_ns: last good answer; 0: none
Device = collections.namedtuple("Device", "id family identity power target answers errors retries "
                                "wire_us ok_ns")
POWERS = {1: "parasite", 2: "external"}
TARGET_STATES = ["down", "up", "suspended"]

# What the file says of a signal. None: not given, not known; scale and offset are 1 and 0 without,
# points is the text of the file
Info = collections.namedtuple(
    "Info", "name path type output fresh alarm per_factor stale_after_ns unit description family "
    "device calibrated points decimals scale offset min max limit_hh limit_h limit_l limit_ll "
    "filter deadband confirm", defaults=[None] * 17 + [False])
INFO = struct.Struct("<4I3q8I10d")


def now_ns():
    """The clock of all times here."""
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME)


def check(words):
    h = 0x9E3779B9
    for word in words:
        h = (h ^ word) * 0x85EBCA6B & 0xFFFFFFFF
        h ^= h >> 15
    return h


def check_bytes(text):
    h = 0x9E3779B9 ^ len(text)
    for byte in text:
        h = (h ^ byte) * 0x85EBCA6B & 0xFFFFFFFF
        h ^= h >> 15
    return h


def plain(text):
    """A text that is filled up with NUL."""
    return text.split(b"\0")[0].decode(errors="replace")


def by(raw):
    serial, uid, pid, name, person = WHO.unpack(raw)
    return By(serial, uid, pid, plain(name), plain(person))


class Futex:
    """Waiting and waking through the C library's syscall(), where there is one."""

    NUMBERS = {"x86_64": 202, "aarch64": 98, "riscv64": 98, "ppc64le": 221, "s390x": 238}

    def __init__(self):
        # 32-bit systems: the call with 64-bit times has one number everywhere
        self.number = 422 if sys.maxsize < 2**32 else self.NUMBERS.get(platform.machine())
        try:
            self.syscall = ctypes.CDLL(None, use_errno=True).syscall
            self.syscall.restype = ctypes.c_long
        except (OSError, AttributeError):
            self.number = None

    @staticmethod
    def address(memory):
        """Where a read-only mapping lies: ctypes has that only for writable ones."""
        class Buffer(ctypes.Structure):
            _fields_ = [("buf", ctypes.c_void_p), ("obj", ctypes.py_object),
                        ("len", ctypes.c_ssize_t), ("itemsize", ctypes.c_ssize_t),
                        ("readonly", ctypes.c_int), ("ndim", ctypes.c_int),
                        ("format", ctypes.c_char_p), ("shape", ctypes.c_void_p),
                        ("strides", ctypes.c_void_p), ("suboffsets", ctypes.c_void_p),
                        ("internal", ctypes.c_void_p)]
        buffer = Buffer()
        ctypes.pythonapi.PyObject_GetBuffer(ctypes.py_object(memory), ctypes.byref(buffer), 0)
        address = buffer.buf
        ctypes.pythonapi.PyBuffer_Release(ctypes.byref(buffer))
        return address

    def wait(self, address, seen, seconds):
        """Sleeps while the word is as seen; without futex for a hundredth of a second."""
        if self.number is None:
            time.sleep(min(seconds, 0.01))
            return
        seconds = min(seconds, 3600)
        whole = int(seconds)
        timeout = struct.pack("=qq", whole, int((seconds - whole) * 1e9))
        self.syscall(ctypes.c_long(self.number), ctypes.c_void_p(address), ctypes.c_long(0),
                     ctypes.c_ulong(seen), ctypes.c_char_p(timeout), None, ctypes.c_long(0))


class Mapped:
    """A mapped file: its bytes, and its words as single 32- and 64-bit loads and stores."""

    def __init__(self, fd, size, writable):
        """Closes the descriptor."""
        self.size, self.memory, self.words, self.doubles = size, None, None, None
        try:
            self.memory = mmap.mmap(fd, size, mmap.MAP_SHARED,
                                    mmap.PROT_READ | (mmap.PROT_WRITE if writable else 0))
            self.words = memoryview(self.memory).cast("I")
            self.doubles = memoryview(self.memory).cast("Q")
        except BaseException:
            self.close()
            raise
        finally:
            os.close(fd)

    def word(self, offset):
        return self.words[offset >> 2]

    def string(self, offset, pool):
        """A text of the pool; "" for an offset that is none."""
        if not pool.off <= offset < pool.off + pool.count:
            return ""
        end = self.memory.find(b"\0", offset, pool.off + pool.count)
        return self.memory[offset:end].decode(errors="replace") if end >= 0 else ""

    def inside(self, offset, count, size):
        if offset % 8 or offset + count * size > self.size:
            raise broken()

    def close(self):
        for view in (self.words, self.doubles, self.memory):
            if view is not None:
                view.release() if isinstance(view, memoryview) else view.close()
        self.words = self.doubles = self.memory = None


class Image(Mapped):
    """The image of an instance."""

    def __init__(self, place, instance):
        self.path = f"{place}/{instance}.image"
        folder = open_place(place)
        try:
            fd = os.open(f"{instance}.image", os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC |
                         os.O_NONBLOCK, dir_fd=folder)
        finally:
            os.close(folder)
        status = os.fstat(fd)
        if not stat.S_ISREG(status.st_mode) or not trusted(status.st_uid):
            os.close(fd)
            raise PermissionError(errno.EPERM, "belongs to another user", self.path)
        if status.st_size < 256 or status.st_size % 8:
            os.close(fd)
            raise broken()
        self.file = status.st_dev, status.st_ino
        super().__init__(fd, status.st_size, False)
        self.address = Futex.address(self.memory)

    def replaced(self):
        """Does its name lead to another file? One that is gone leads nowhere yet."""
        try:
            there = os.lstat(self.path)
        except OSError:
            return False
        return (there.st_dev, there.st_ino) != self.file


class Door:
    """The connection to owsd's control socket. It lasts as long as this program commands."""

    def __init__(self, place, instance, name, command, token=bytes(16)):
        self.bell = self.news = -1
        self.new, self.closed = True, False
        self.token = token
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            directory = open_place(place)
            try:
                self.socket.connect(f"/proc/self/fd/{directory}/{instance}.control")
            finally:
                os.close(directory)
            self.socket.setblocking(False)
            self.socket.send(HELLO.pack(HELLO_MAGIC, MAJOR, 0, HELLO_COMMAND if command else 0,
                                        token, name.encode()[:NAME_SIZE - 1]))
        except BaseException as e:
            self.close()
            if isinstance(e, (ConnectionError, BlockingIOError)):
                raise FileNotFoundError(errno.ENOENT, "owsd does not run") from None
            raise

    def receive(self, seconds):
        """A welcome and the descriptor of its memory; None: none has come in that time."""
        ready = select.poll()
        ready.register(self.socket, select.POLLIN)
        if not ready.poll(seconds * 1000):
            return None
        data, fds, flags, _ = socket.recv_fds(self.socket, WELCOME.size, 4,
                                              socket.MSG_CMSG_CLOEXEC)
        try:
            if not data:
                raise ConnectionResetError(errno.ENOTCONN, "owsd has hung up")
            if len(data) < WELCOME.size:
                raise broken()
            welcome = Welcome(*WELCOME.unpack(data))
            if welcome.magic != WELCOME_MAGIC or welcome.err > 0:
                raise broken()
            if welcome.err:
                raise OSError(-welcome.err, os.strerror(-welcome.err))
            if welcome.major != MAJOR or flags & socket.MSG_CTRUNC or \
               len(fds) != (3 if self.new else 1):
                raise broken()
        except BaseException:
            for fd in fds:
                os.close(fd)
            self.close()
            raise
        if self.new:
            self.bell, self.news = fds[1:]
        self.new, self.token = False, welcome.token
        return welcome, fds[0]

    def ring(self):
        try:
            os.write(self.bell, b"\1" + bytes(7))
        except BlockingIOError:
            pass  # it has rung already

    def hung_up(self, seconds):
        """Sleep until there are news; true: owsd is gone, and nobody wakes this any more."""
        ready = select.poll()
        ready.register(self.news, select.POLLIN)
        return any(event & select.POLLHUP for _, event in ready.poll(seconds * 1000))

    def drain(self):
        ready = select.poll()
        ready.register(self.news, select.POLLIN)
        while any(event & select.POLLIN for _, event in ready.poll(0)):
            if not os.read(self.news, 64):
                break

    def close(self):
        self.closed = True
        self.socket.close()
        for fd in (self.bell, self.news):
            if fd >= 0:
                os.close(fd)
        self.bell = self.news = -1


class Memory(Mapped):
    """The memory in which this program commands, of one generation of owsd."""

    def __init__(self, fd, welcome):
        # Without these seals an access could raise SIGBUS
        if fcntl.fcntl(fd, F_GET_SEALS) & SEALS != SEALS or \
           os.fstat(fd).st_size != welcome.size or welcome.size < GIVER_HEADER_SIZE:
            os.close(fd)
            raise broken()
        super().__init__(fd, welcome.size, True)
        try:
            self.serial = welcome.serial
            self.header = h = GiverHeader(*GIVER_HEADER.unpack_from(self.memory))
            if (h.magic, h.major, h.size, h.generation, h.start_id) != \
               (GIVER_MAGIC, MAJOR, self.size, welcome.generation, welcome.start_id) or \
               h.slot_size < COMMAND_SLOT_SIZE or h.slot_size % 8 or h.text_cap % 4:
                raise broken()
            for offset, count, size in ((h.slot_off, h.slot_count, h.slot_size),
                                        (h.dirty_off, (h.slot_count + 31) // 32, 4),
                                        (h.place_off, h.slot_count, 4), (h.text_off, 0, 1),
                                        (h.person_off, PERSONS, NAME_SIZE),
                                        (h.shelf_off, 1, SHELF_SIZE)):
                self.inside(offset, count, size)
        except BaseException:
            self.close()
            raise

    def live(self):
        return self.word(GIVER_STATE) == LIVE

    def fits(self, header, count):
        mine = self.header
        return self.live() and mine.slot_count == count and \
            (mine.generation, mine.start_id) == (header.generation, header.start_id)

    def slot(self, record):
        """Where the words of a slot begin: as an index of words."""
        return self.header.slot_off + record * self.header.slot_size >> 2

    def store(self, at, value):
        self.words[at] = value & 0xFFFFFFFF

    def count(self, at):
        self.store(at, self.words[at] + 1)

    def mark(self, record):
        # owsd clears marks meanwhile: one that comes back makes it look once more
        self.words[(self.header.dirty_off >> 2) + record // 32] |= 1 << record % 32

    def text(self, record, text):
        h = self.header
        place = self.words[(h.place_off >> 2) + record]
        offset = h.text_off + place * (8 + h.text_cap)
        if offset + 8 + h.text_cap > self.size:
            raise broken()
        self.store(offset >> 2, len(text))
        self.memory[offset + 8:offset + 8 + len(text)] = text
        self.store(offset + 4 >> 2, check_bytes(text))

    def person(self, name):
        """The place of a person's name, entered if it is not there."""
        wanted, h = name.ljust(NAME_SIZE, b"\0"), self.header
        places = [h.person_off + i * NAME_SIZE for i in range(PERSONS)]
        there = [self.memory[at:at + NAME_SIZE] for at in places]
        for word in (wanted, bytes(NAME_SIZE)):
            if word in there:
                place = there.index(word)
                break
        else:
            place = next(iter(set(range(PERSONS)) - self._persons_in_use()), None)
            if place is None:
                raise BlockingIOError(errno.EBUSY, "owsd has still to look at all persons")
        if there[place] != wanted:
            self.memory[places[place]:places[place] + NAME_SIZE] = wanted
        return place + 1

    def _persons_in_use(self):
        """The places of persons for whom owsd has something to look at."""
        used = set()
        for record in range(self.header.slot_count):
            at = self.slot(record)
            marks = self.words[(self.header.dirty_off >> 2) + record // 32]
            if marks >> record % 32 & 1 or \
               self.words[at + SLOT_STAMP] != self.words[at + SLOT_TAKEN]:
                used.add(self.words[at + SLOT_PERSON] - 1)
        return used

def trusted(uid):
    return uid in (0, os.geteuid(), user("owsd"))


def user(name):
    try:
        return pwd.getpwnam(name).pw_uid
    except KeyError:
        return None


def places():
    """The directories where instances are, in the order of looking: as libows(3) has them."""
    uid = os.geteuid()
    mine = uid == os.getuid()  # a program for another user takes no directory from the caller
    named, runtime = (mine and os.environ.get(key) for key in ("OWS_DIR", "XDG_RUNTIME_DIR"))
    if named:
        named = named.rstrip("/")
        if not named.startswith("/") or len(os.fsencode(named)) > 191 or named.endswith(("/.", "/..")):
            raise OSError(errno.EINVAL, "OWS_DIR is no absolute path of a directory", named)
        return [named]
    if uid in (0, user("owsd")):
        return [SERVICE]
    own = f"{runtime.rstrip('/')}/owsd" if runtime and runtime.startswith("/") else ""
    return [own if 0 < len(os.fsencode(own)) < 192 else f"/dev/shm/owsd-{uid}", SERVICE]


def open_place(path):
    """The descriptor of a directory in which only root, owsd or this user may make files."""
    try:
        folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError as why:
        if why.errno in (errno.ELOOP, errno.ENOTDIR):
            raise PermissionError(errno.EPERM, "a link, or no directory", path) from None
        raise
    status = os.fstat(folder)
    if trusted(status.st_uid) and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return folder
    os.close(folder)
    raise PermissionError(errno.EPERM, "others may write into it", path)


def broken():
    return OSError(errno.EPROTO, "no segment of owsd, or of another layout")


class Ows:
    """An instance of owsd. All times are nanoseconds of CLOCK_BOOTTIME where the name says _ns."""

    def __init__(self, instance="OWS", control=False, name=None):
        """name: of this program, as owsd shows it; without it the script's own."""
        self.instance, self.control = instance, control
        self.program = name or os.path.basename(sys.argv[0] or "python")
        self.image = self.door = self.memory = self.next = None
        self.seen_alarms, self.levels = {}, {}
        self.stamp = self.period_ms = self.person = 0
        self.person_name = b""
        self.pid = os.getpid()
        self.futex = Futex()
        self._find_place()
        if control:
            try:
                self._join()
            except BaseException:
                self.close()
                raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # --- Opening --------------------------------------------------------------------------------

    def _find_place(self):
        """Open in the first place with a living owsd of that name, else in the first with its
        image; reopen() stays there."""
        where, reason = places(), None
        for anything in (False, True) if len(where) > 1 else (True,):
            for self.place in where:
                try:
                    self._take(*self._map())
                except OSError as why:
                    if reason is None or reason.errno == errno.ENOENT:
                        reason = why
                    continue
                if anything or self.alive():
                    return
                self.image.close()
                self.image = None
        raise reason

    def _map(self):
        image = Image(self.place, self.instance)
        try:
            return image, *self._check_image(image)
        except BaseException:
            image.close()
            raise

    def _take(self, image, header, areas):
        if self.image is not None:
            if header.start_ns != self.header.start_ns:
                self.seen_alarms.clear()
            self.image.close()
        self.image, self.header, self.areas = image, header, areas
        self.dead_after_ns = max(2_000_000_000, 3 * header.period_ns)
        self.looked_ns, self.orphan = None, False
        self._read_table()

    @staticmethod
    def _check_image(image):
        header = Header(*HEADER.unpack_from(image.memory))
        if (header.magic, header.major, header.size) != (IMAGE_MAGIC, MAJOR, image.size):
            raise broken()
        image.inside(header.area_off, header.area_count, AREA.size)
        areas = {kind: Area() for kind in ENTRY_SIZES}
        for i in range(header.area_count):
            kind, *area = AREA.unpack_from(image.memory, header.area_off + i * AREA.size)
            area, least = Area(*area), ENTRY_SIZES.get(kind)
            if least is None or not area.count:
                continue
            # A later minor version may have larger entries
            if areas[kind].count or area.size < least or area.size % min(least, 8) or \
               least == 1 != area.size:
                raise broken()
            image.inside(area.off, area.count, area.size)
            areas[kind] = area
        if not areas[RECORDS].count or areas[INFOS].count != areas[RECORDS].count or \
           areas[CHANGES].count & (areas[CHANGES].count - 1):
            raise broken()
        return header, areas

    def _read_table(self):
        """What does not change while a generation lives."""
        image, texts, pool = self.image, self.areas[TEXTS], self.areas[POOL]
        self.records, self.table = {}, []
        for record in range(self.areas[RECORDS].count):
            (name, path, factor, _, stale, _, _, said, *texts_off, decimals, scale, offset,
             minimum, maximum, hh, h, low, ll, smooth, deadband) = INFO.unpack_from(
                 image.memory, self._at(INFOS, record))
            text_off, kind, flags, text_cap = struct.unpack_from(
                "<IBBH", image.memory, self._at(RECORDS, record) + 4)
            if text_cap and not \
               texts.off <= text_off <= texts.off + texts.count - 2 * text_cap:
                raise broken()
            name = image.string(name, pool)
            path = image.string(path, pool)
            self.table.append((Info(name, path, kind, bool(flags & OUTPUT), bool(flags & FRESH),
                                    bool(flags & ALARM), factor, stale,
                                    *(image.string(off, pool) or None for off in texts_off),
                                    None if decimals == 0xFFFFFFFF else decimals, scale, offset,
                                    *(None if number != number else number for number in
                                      (minimum, maximum, hh, h, low, ll)), smooth, deadband,
                                    bool(said & CONFIRM)),
                               text_off, text_cap, bool(flags & NO_SET)))
            if record > 0:
                self.records[name] = record

    def _at(self, kind, i):
        """Where entry i of an area is."""
        return self.areas[kind].off + i * self.areas[kind].size

    def close(self):
        """Say goodbye to owsd: what was set stays in force, also if a beat was promised. A program
        that ends without this is lost to owsd."""
        if self.memory is not None and not self._forked():
            self.memory.store(GIVER_GOODBYE >> 2, 1)
        for thing in (self.door, self.memory, self.next, self.image):
            if thing is not None:
                thing.close()
        self.image = self.door = self.memory = self.next = None

    def reopen(self):
        """Map the present image after Stale, and go on as the same giver. FileNotFoundError: not
        there yet, try again; what is mapped stays readable."""
        if self.door is not None and self._forked():
            raise PermissionError(errno.EPERM, "belongs to the process before the fork")
        image, header, areas = self._map()
        try:
            if image.word(STATE_OFF) != LIVE or \
               self.door is not None and not self._meet(header, areas, 0.02):
                raise FileNotFoundError(errno.ENOENT, "the new image is not there yet")
        except BaseException:
            image.close()
            raise
        self._take(image, header, areas)
        self._take_memory()

    # --- Becoming a giver -----------------------------------------------------------------------

    def _forked(self):
        return os.getpid() != self.pid

    def _join(self):
        """Connect, and wait for owsd's welcome; the image may be replaced meanwhile."""
        until = time.monotonic() + 2
        while not self._meet(self.header, self.areas, 0.05):
            if time.monotonic() >= until:
                raise TimeoutError(errno.ETIMEDOUT, "owsd does not answer")
            self._take(*self._map())
        self._take_memory()

    def _connect(self):
        """Nobody looks at the memory of the connection before."""
        token = bytes(16)
        if self.door is not None:
            token = self.door.token
            self.door.close()
        if self.memory is not None:
            self.memory.store(GIVER_STATE >> 2, STOPPED)
        if self.next is not None:
            self.next.close()
        self.next = None
        self.door = Door(self.place, self.instance, self.program, self.control, token)

    def _meet(self, header, areas, seconds):
        """Get the memory that belongs to an image. False: owsd has not handed it out yet."""
        until, count = time.monotonic() + seconds, areas[RECORDS].count
        connected = self.door is None or self.door.closed
        if connected:
            self._connect()
        while True:
            has = self.next is not None and self.next.fits(header, count) or \
                not self.door.new and self.memory is not None and self.memory.fits(header, count)
            try:
                # All that have come are taken, so that the last one stays
                got = self.door.receive(0 if has else max(0, until - time.monotonic()))
            except ConnectionError:
                if connected:
                    raise FileNotFoundError(errno.ENOENT, "owsd does not run") from None
                connected = True
                self._connect()
                continue
            if got is None:
                return has
            welcome, fd = got
            try:
                memory = Memory(fd, welcome)
            except OSError:
                if welcome.start_id == header.start_id:
                    raise
                continue  # of a generation that has gone
            if self.next is not None:
                self.next.close()
            self.next = memory

    def _take_memory(self):
        if self.next is None:
            return
        if self.memory is not None:
            self.memory.close()
        self.memory, self.next = self.next, None
        if not self.control:
            return
        self.person = self.memory.person(self.person_name) if self.person_name else 0
        if self.period_ms:  # a giver that comes back beats at once
            self._store_beat()
            self._ring()

    # --- Names ----------------------------------------------------------------------------------

    def find(self, name):
        """(record, attribute) of a name: a signal's, a driver signal's, or one with an attribute.
        Raises KeyError."""
        if not isinstance(name, str):
            raise TypeError(f"a name is text, not {name!r}")
        prefix = self.instance + "__"
        forms = [name] + ([name[len(prefix):]] if name.startswith(prefix) else [])
        for form in forms:
            if form in self.records:
                return self.records[form], "_Value"
        for form in forms:
            if form in DRIVER:
                return 0, form
        for form in forms:
            best = None
            for attribute in ATTRIBUTES:
                for suffix in attribute[:2]:
                    stem = form[:-len(suffix)] if suffix and form.endswith(suffix) else None
                    if stem in self.records and (best is None or len(stem) > len(best[0])):
                        best = stem, attribute[0]
            if best:
                return self.records[best[0]], best[1]
        raise KeyError(name)

    def names(self):
        return [row[0].name for row in self.table[1:]]

    def info(self, name):
        return self.table[self.find(name)[0]][0]

    # --- Reading --------------------------------------------------------------------------------

    def _slot(self, record, want_text=False):
        """A whole sample and its attributes, and the text if wanted, verified."""
        words, memory = self.image.words, self.image.memory
        base = self._at(RECORDS, record)
        _, text_off, text_cap, _ = self.table[record]
        for _ in range(WHOLE_TRIES):
            seq = words[base >> 2]
            half = seq >> 1 & 1
            raw = memory[base + 16 + 128 * half:base + 144 + 128 * half]
            text = memory[text_off + half * text_cap:text_off + (half + 1) * text_cap] \
                if want_text else b""
            if (words[base >> 2] - (seq & ~1)) & 0xFFFFFFFF > 2:
                continue
            both = struct.unpack("<32I", raw)
            # A record that was never published is zero, and so are its check words
            if seq >= 2 and (check(both[:11]) != both[11] or check(both[12:31]) != both[31]):
                continue
            return SAMPLE.unpack(raw[:48]), Attrs(*ATTRS.unpack(raw[48:])), text
        raise BlockingIOError(errno.EAGAIN, "no whole sample")

    def _state(self):
        return self.image.word(STATE_OFF)

    def alive(self, now=None):
        """Is owsd there and its heart beating?"""
        return self._state() == LIVE and self._beats(now or now_ns())

    def _beats(self, now):
        try:
            sample, _, _ = self._slot(0)
        except BlockingIOError:
            return False
        # A heart that beats in the future is dead too, unless now was taken just before the beat
        return abs(now - sample[1]) <= self.dead_after_ns

    def stale(self):
        """True when reopen() is due: owsd says so in the image, or its heart stands still and the
        name leads to the image of another."""
        return self._state() != LIVE or self._is_orphan()

    def _is_orphan(self):
        """Of an owsd that was killed, and whose image lost its name before the next one could say
        anything in it. Looks once a second, and only while the heart stands."""
        now = now_ns()
        if self.looked_ns is None or now - self.looked_ns >= ORPHAN_LOOK_NS:
            self.looked_ns = now
            self.orphan = not self._beats(now) and self.image.replaced()
        return self.orphan

    def get(self, name, now=None):
        """The Value of a name. Never raises for a dead or restarted owsd: the value is not good
        then, and stale() or alive() say why. After a reload it stays good for the two seconds in
        which reopen() is due. KeyError: no such name; PermissionError: it is
        write-only."""
        record, attribute = self.find(name)
        now = now or now_ns()
        info = self.table[record][0]
        is_text, data = info.type == STRING and attribute == "_Value", None
        sample, attrs, text = self._slot(record, is_text)
        raw, measured, tried, err, quality, detail, target, _, count, _, length, _ = sample
        applied = self.memory.words[self.memory.slot(record) + SLOT_APPLIED] if self.memory else 0
        age = max(0, now - (measured or self.header.start_ns))
        if attribute == "_Raw":
            # a measurement, as old and as good as the value that was made of it
            kind, value = DOUBLE, decode(DOUBLE, attrs.raw)
            quality = Q_TYPE if info.type == STRING else quality
        elif attribute != "_Value" or record == 0:
            kind, readable = self._kind(record, attribute)
            if not readable:
                raise PermissionError(errno.EACCES, "write-only", name)
            value, quality = self._attribute(record, attribute, sample, attrs, age, now), \
                Q_GOOD
        else:
            kind = info.type
            data = bytes(text[:length]) if is_text else None
            value = data.decode(errors="replace") if is_text else decode(kind, raw)
        if quality & 0xC0 == 0xC0:
            # a retired image was exchanged for another: its last heartbeat says how old it is
            since = measured or self.header.start_ns
            if self._state() not in (LIVE, RETIRED) or not self._beats(now) or \
                    since > now + self.dead_after_ns:
                quality = Q_TARGET
            elif attribute in ("_Value", "_Raw") and record and 0 < info.stale_after_ns < age:
                quality = Q_STALE
        return Value(value, kind, quality, detail, target, err, measured, tried, age / 1e9, count,
                     applied, data)

    @staticmethod
    def _kind(record, attribute):
        if record == 0:
            return DRIVER[attribute][0], DRIVER[attribute][1]
        return ATTRIBUTE[attribute][2], ATTRIBUTE[attribute][3]

    def _present_period(self, now):
        """Of owsd, whose heart may beat after several periods."""
        sample, attrs, _ = self._slot(0)
        since, length = now - sample[1], self.header.period_ns
        return attrs.per_base + (since // length if since > 0 and length > 0 else 0)

    def _attribute(self, record, attribute, sample, attrs, age_ns, now):
        info = self.table[record][0]
        if attribute == "_RECONNECTS":
            return decode(LARGE, sample[0])
        if attribute == "_Alarm":
            seen = self.seen_alarms.get(info.name, 0)
            self.seen_alarms[info.name] = attrs.alarms
            return attrs.alarms != seen
        period = self._present_period(now)
        count = periods(period, attrs.per_base)
        pending = periods(period, attrs.pend_base) if attrs.flags & IN_WORK else 0
        return {
            "_TRANSACTIONS": attrs.transactions,
            "_ReadEnable": bool(attrs.flags & READ_ENABLE),
            "_WriteEnable": bool(attrs.flags & WRITE_ENABLE),
            "_PerFactor": info.per_factor,
            "_PerCount": count,
            "_PerMax": max(attrs.per_max, count),
            "_PendCount": pending,
            "_PendLast": attrs.pend_last,
            "_PendMax": max(attrs.pend_max, pending),
            "_Period": attrs.update_ns / 1e9,
            "_Age": age_ns / 1e9,
            "_AgeMax": max(attrs.age_max_ns, age_ns) / 1e9,
        }[attribute]

    def alarms(self, since=0):
        """The journal of alarms from number `since` on, as far as it is kept: AlarmEntry by
        AlarmEntry. The number after the last is where to go on."""
        for number, entry in self._journal(ALARMS, ALARM_HEAD_OFF, since):
            (_, record, occurred, before, after, kind, event, quality, flags, _, text, who, _,
             _) = entry
            info = self.table[record][0]
            yield AlarmEntry(number, info.name, occurred,
                             decode(info.type, before) if flags & 1 else None,
                             decode(info.type, after) if flags & 2 else None,
                             word(ALARM_KINDS, kind, "none"), word(ALARM_EVENTS, event, "unknown"),
                             quality, plain(text), by(who))

    def commands(self, since=0):
        """The journal of commands, likewise: CommandEntry by CommandEntry."""
        for number, entry in self._journal(COMMANDS, COMMAND_HEAD_OFF, since):
            _, record, taken, _, value, reason, _, quality, _, more, text, who, _, _ = entry
            info = self.table[record][0]
            yield CommandEntry(number, info.name, taken,
                               plain(text) if info.type == STRING else decode(info.type, value),
                               word(REASONS, reason, "unknown"), quality, more, by(who))

    def _journal(self, kind, head_off, since):
        head = self.image.word(head_off)
        for number in range(max(since, head - self.areas[kind].count), head):
            entry = self._entry(kind, number % self.areas[kind].count, JOURNAL_ENTRY)
            if entry is not None and entry[-2] == number and 0 < entry[1] < len(self.table):
                yield number, entry

    def _entry(self, kind, i, layout):
        """A whole entry that begins with seq and ends with check; None: its writer was killed."""
        at = self._at(kind, i)
        for _ in range(WHOLE_TRIES):
            raw = self.image.memory[at:at + layout.size]
            words = struct.unpack(f"<{layout.size // 4}I", raw)
            # An entry that was never written is zero, and so is its check word
            if words[0] % 2 == 0 and (check(words[1:-1]) == words[-1] or not any(words)):
                return layout.unpack(raw)
        return None

    def alarm_state(self, name):
        """The AlarmState of a signal: how its device's alarm and its limit alarm stand."""
        record, _ = self.find(name)
        if record == 0:
            raise KeyError(name)
        attrs = self._slot(record)[1]
        return AlarmState(attrs.alarms, bool(attrs.flags & ALARM_STANDS),
                          bool(attrs.flags & ALARM_POLLED), bool(attrs.flags & LIMITS),
                          word(LIMIT_STATES, attrs.limit_state, "unknown"),
                          word(ALARM_KINDS, attrs.limit_condition, "none"),
                          bool(attrs.flags & ALARM_UNARMED),
                          self._shelf(record) if attrs.shelved else None)

    def _shelf(self, record):
        for i in range(self.areas[SHELVES].count):
            entry = self._entry(SHELVES, i, SHELF_ENTRY)
            if entry is not None and entry[1] == record:
                _, _, since, until, who, why, _ = entry
                return Shelf(since, until, by(who), plain(why))
        return None

    def targets(self):
        """All targets: Target by Target."""
        for index in range(self.areas[TARGETS].count):
            name, state, reconnects, group, moves = TARGET.unpack_from(
                self.image.memory, self._at(TARGETS, index))
            yield Target(index, name.split(b"\0")[0].decode(errors="replace"),
                         word(TARGET_STATES, state, "unknown"), reconnects, group, moves)

    def devices(self):
        """What owsd knows of each device that signals name, by ROM id: Device by Device."""
        for index in range(self.areas[DEVICES].count):
            entry = self._entry(DEVICES, index, DEVICE_ENTRY)
            if entry is None:
                continue
            _, name, family, target, answers, errors, retries, wire_us, ok_ns, power, identity, _ = \
                entry
            yield Device(*(self.image.string(off, self.areas[POOL]) or None
                           for off in (name, family)),
                         identity.split(b"\0")[0].decode(errors="replace") or None,
                         POWERS.get(power),
                         target if target < self.areas[TARGETS].count else None,
                         answers, errors, retries, wire_us, ok_ns)

    def origin(self, name):
        """The Origin of the command that is in force for a signal."""
        record, _ = self.find(name)
        if record == 0:
            raise KeyError(name)
        entry = self._entry(ORIGINS, record, ORIGIN_ENTRY)
        if entry is None:
            raise OSError(errno.EIO, "owsd was killed while it wrote this")
        _, reason, taken, who, _ = entry
        who = by(who)
        own = self.memory is not None and who.serial == self.memory.serial
        return Origin(who, taken, word(REASONS, reason, "unknown"), own)

    def givers(self):
        """The programs that are connected to owsd: Giver by Giver."""
        for place in range(self.areas[GIVERS].count):
            entry = self._entry(GIVERS, place, GIVER_ENTRY)
            if entry is not None and entry[1] & GIVER_CONNECTED:
                _, flags, joined, who, period_ms, commands, refused, _ = entry
                yield Giver(by(who), joined, period_ms, commands, refused,
                            bool(flags & GIVER_MAY_SET), bool(flags & GIVER_LATE))

    def fileno(self):
        """A descriptor for select and poll: readable when something is published after this call.
        Call it again before each poll, and after reopen(); do not read it. A reader connects to
        owsd at the first call."""
        if self.door is None:
            self._join()
        self._arm()
        if self.door.news < 0:
            raise Stale
        return self.door.news

    def _arm(self):
        self.door.drain()
        self.memory.store(GIVER_WAITS >> 2, 1)

    def _sleep(self, news, seconds):
        """Sleep until there are other news than these; a connected program needs no futex."""
        if self.door is None or self.door.news < 0 or self._forked():
            self.futex.wait(self.image.address + NEWS_OFF, news, seconds)
            return
        self._arm()
        if self.image.word(NEWS_OFF) == news and self.door.hung_up(seconds):
            self.futex.wait(self.image.address + NEWS_OFF, news, seconds)

    def wait(self, news=0, seconds=math.inf):
        """Sleep until something was published after `news`; returns the new number to hand in next
        time, or the same when the time is over. Raises Stale."""
        until = time.monotonic() + seconds
        while True:
            now = self.image.word(NEWS_OFF)
            if self.stale():
                raise Stale
            left = until - time.monotonic()
            if now != news or left <= 0:
                return now
            # Nobody wakes who sleeps on an orphan
            self._sleep(now, min(left, 1))

    def changes(self, seconds=math.inf):
        """Follow what changes: an iterator of Changed, which are names of signals. It waits for
        the next change, at most `seconds`, and gives an empty one when they are over. Begins with
        all signals. Raises Stale: reopen(), and go on with the same iterator."""
        if not self.areas[CHANGES].count:
            raise OSError(errno.EOPNOTSUPP, "this owsd has no ring of changes")
        return Changes(self, seconds)

    # --- Setting --------------------------------------------------------------------------------

    def set(self, name, value):
        """Command an output or a writable attribute. Returns the stamp that Value.applied will
        reach (attributes: 0). TypeError: text where a number is expected, or the other way
        round; ValueError: the type or its range cannot hold it; PermissionError: not writable, or
        not by this user, with errno EROFS an input whose Writable is off in the configuration,
        with EPERM after a fork; Stale."""
        record, attribute = self.find(name)
        if not self.control:
            raise PermissionError(errno.EACCES, "opened without control", name)
        if self.table[record][3] and attribute in ("_Value", "_WriteEnable", "_WriteOneShot"):
            raise PermissionError(errno.EROFS, "an input, and Writable is off", name)
        slot = self._ready(record, name)
        if attribute == "_Value" and record:
            stamp = self._set_signal(record, slot, name, value)
        else:
            stamp = 0
            need_number(value)
            self._set_flag(record, attribute, slot, name, bool(value))
        self.memory.mark(record)
        self._ring()
        return stamp

    def acknowledge(self, name):
        """Acknowledge the limit alarm of a signal; nothing happens if none is unacknowledged."""
        record, _ = self.find(name)
        if record == 0:
            raise KeyError(name)
        slot = self._ready(record, name)
        self.memory.store(slot + SLOT_PERSON, self.person)
        self.memory.count(slot + SLOT_ACKNOWLEDGED)
        self.memory.mark(record)
        self._ring()

    def shelve(self, name, seconds, why=""):
        """Shelve the limit alarm of a signal for so many seconds; 0: unshelve it. Waits until owsd
        has done that, two seconds at most."""
        record, _ = self.find(name)
        if record == 0:
            raise KeyError(name)
        self._ready(record, name)
        text = why.encode()
        if len(text) >= TEXT_SIZE or b"\0" in text:
            raise ValueError("longer than 63 bytes, or with a NUL")
        memory, at = self.memory, self.memory.header.shelf_off >> 2
        count, done = memory.words[at], at + (SHELF_SIZE - 16 >> 2)
        if memory.words[done] != count:
            raise BlockingIOError(errno.EBUSY, "owsd has not answered the request before")
        for i, value in enumerate((record, seconds, self.person)):
            memory.store(at + 1 + i, value)
        start = memory.header.shelf_off + 16
        memory.memory[start:start + TEXT_SIZE] = text.ljust(TEXT_SIZE, b"\0")
        memory.count(at)
        self._ring()
        until = time.monotonic() + 2
        while memory.words[done] != memory.words[at]:
            if time.monotonic() > until:
                raise TimeoutError(errno.ETIMEDOUT, "owsd does not answer")
            time.sleep(0.001)
        error = -memory.words[done + 1] & 0xFFFFFFFF
        if error:
            raise OSError(error, os.strerror(error), name)

    def for_person(self, name):
        """From now on this object commands for that person: a claim, which owsd shows. None: for
        itself. BlockingIOError: owsd has still to look at the commands of 16 other persons."""
        if not self.control:
            raise PermissionError(errno.EACCES, "opened without control")
        if self._forked():
            raise PermissionError(errno.EPERM, "belongs to the process before the fork")
        text = (name or "").encode()
        if len(text) >= NAME_SIZE or b"\0" in text:
            raise ValueError("longer than 31 bytes, or with a NUL")
        self.person = self.memory.person(text) if text else 0
        self.person_name = text

    def _ready(self, record, name):
        """Where the slot's words begin. Nobody takes what is set in a memory whose owsd has ended,
        or that was replaced."""
        if not self.control:
            raise PermissionError(errno.EACCES, "opened without control", name)
        if self._forked():
            raise PermissionError(errno.EPERM, "belongs to the process before the fork", name)
        slot = self.memory.slot(record)
        if not self.memory.live() or not self.alive():
            raise Stale
        if not self.memory.words[slot + SLOT_ALLOWED]:
            raise PermissionError(errno.EACCES, "not by this user", name)
        return slot

    def _set_signal(self, record, slot, name, value):
        info, memory = self.table[record][0], self.memory
        writable = info.output or memory.words[slot + SLOT_WRITE_ENABLE] % 4 == 2 or \
            self._slot(record)[1].flags & WRITE_ENABLE
        if not writable:
            raise PermissionError(errno.EACCES, "not writable", name)
        if info.type == STRING:
            if not isinstance(value, str):
                raise TypeError(f"{name} is a string and takes text, not {value!r}")
            text = value.encode()
            if len(text) > memory.header.text_cap or b"\0" in text:
                raise ValueError("longer than the room in the layout, or with a NUL")
            memory.text(record, text)
        else:
            word = encode(info.type, value)
            if info.min is not None and value < info.min or \
               info.max is not None and value > info.max:
                raise ValueError(f"{name} is limited to {info.min} to {info.max}")
            memory.doubles[slot >> 1] = word
        memory.store(slot + SLOT_PERSON, self.person)
        self.stamp = self.stamp + 1 & 0xFFFFFFFF or 1
        memory.store(slot + SLOT_STAMP, self.stamp)
        return self.stamp

    def _set_flag(self, record, attribute, slot, name, on):
        writable = DRIVER[attribute][2] if record == 0 else ATTRIBUTE[attribute][4]
        if not writable:
            raise PermissionError(errno.EACCES, "not writable", name)
        memory = self.memory
        memory.store(slot + SLOT_PERSON, self.person)
        if attribute in ("_ReadEnable", "_WriteEnable"):
            at = slot + (SLOT_READ_ENABLE if attribute == "_ReadEnable" else SLOT_WRITE_ENABLE)
            memory.store(at, (memory.words[at] // 4 + 1) * 4 + (2 if on else 1))
            return
        key = self.table[record][0].name, attribute
        if on and not self.levels.get(key, False):
            memory.count(slot + (SLOT_ONE_SHOT if attribute == "_WriteOneShot"
                                 else SLOT_DGN_RESET))
        self.levels[key] = on

    def _ring(self):
        self.memory.store(GIVER_MARKED >> 2, 1)
        # Python has no fence, and does not know whether the engine saw this before it slept
        self.door.ring()
        if not self.memory.live():
            raise Stale

    def beat(self, period_ms):
        """Say that this program lives and will say so again within period_ms; if it does not, the
        outputs it set last go to their SafeValue."""
        self._ready_to_beat()
        if not 0 < period_ms <= BEAT_MOST_MS:
            raise ValueError(f"a beat is promised within 1 to {BEAT_MOST_MS} milliseconds, an hour")
        new, self.period_ms = self.period_ms != period_ms, period_ms
        self._store_beat()
        if new:
            self._ring()

    def _ready_to_beat(self):
        if not self.control:
            raise PermissionError(errno.EACCES, "opened without control")
        if self._forked():
            raise PermissionError(errno.EPERM, "belongs to the process before the fork")
        if not self.memory.live() or not self.alive():
            raise Stale

    def _store_beat(self):
        self.memory.store(GIVER_PERIOD >> 2, self.period_ms)
        self.memory.count(GIVER_BEAT >> 2)


class Changed(list):
    """Names of signals that changed, each once. With everything set they are all signals: at the
    beginning, when the program fell behind, and when owsd is lost (all values turned bad) or back."""

    everything = False


class Changes:
    """Made by Ows.changes()."""

    # In that time no ring enters 2**32 changes: a number that is behind by so many looks like new
    KEEPS_NS = 3600 * 1_000_000_000

    def __init__(self, signals, seconds):
        self.signals, self.seconds = signals, seconds
        self.image = self.told = None

    def __iter__(self):
        return self

    def __next__(self):
        until = time.monotonic() + self.seconds
        while True:
            signals = self.signals
            news = signals.image.word(NEWS_OFF)
            changed = self._look(now_ns())
            left = until - time.monotonic()
            if changed or changed.everything or left <= 0:
                return changed
            signals._sleep(news, min(left, self._slice()))

    def _look(self, now):
        signals = self.signals
        alive, state = signals._beats(now), signals._state()
        ended = state == STOPPED
        if state not in (LIVE, STOPPED) or signals._is_orphan() or \
           ended and signals.image.replaced():
            self._stale()
        lost = ended or not alive
        if self.image is not signals.image or lost != self.lost or now - self.looked > self.KEEPS_NS:
            return self._everything(lost, now)
        self.looked = now
        return self._copy(now)

    def _stale(self):
        """A program that does not reopen, or cannot yet, does not spin."""
        if self.told is self.signals.image:
            time.sleep(min(self.seconds, 0.1))
        self.told = self.signals.image
        raise Stale

    def _everything(self, lost, now):
        self.image, self.lost, self.looked = self.signals.image, lost, now
        self.number = self.image.word(CHANGE_HEAD_OFF)
        changed = Changed(self.signals.names())
        changed.everything = True
        return changed

    def _copy(self, now):
        """The last quarter of the ring is not believed: Python has no fences, and may see an entry
        that is being overwritten before it sees the head."""
        ring, first, image = self.signals.areas[CHANGES], self.number, self.image
        behind = image.word(CHANGE_HEAD_OFF) - first & 0xFFFFFFFF
        room = ring.count - ring.count // 4
        records = {}
        for number in range(first, first + min(behind, room)):
            entry = image.doubles[ring.off + number % ring.count * ring.size >> 3]
            if entry & 0xFFFFFFFF != number & 0xFFFFFFFF:
                return self._everything(self.lost, now)
            records[entry >> 32] = None
        if image.word(CHANGE_HEAD_OFF) - first & 0xFFFFFFFF >= room:
            return self._everything(self.lost, now)
        self.number = first + behind & 0xFFFFFFFF
        table = self.signals.table
        return Changed(table[r][0].name for r in records if 0 < r < len(table))

    def _slice(self):
        """The longest sleep in which nothing is missed of which nobody wakes."""
        if self.signals._state() != LIVE:
            return 0.1
        if self.lost:
            return 1
        try:
            beat = self.signals._slot(0)[0][1]
        except BlockingIOError:
            return 0.1
        return max(0.001, min(1, (beat + self.signals.dead_after_ns - now_ns()) / 1e9 + 0.001))


def word(words, number, other):
    return words[number] if number < len(words) else other


def periods(now, base):
    """Periods since a period number, which wraps; 0 when the two were read across a boundary."""
    n = now - base & 0xFFFFFFFF
    return n if n < 2**31 else 0


def decode(kind, raw):
    if kind in (FLOAT, DOUBLE):
        return struct.unpack("<d", raw)[0]
    number = struct.unpack("<q", raw)[0]
    return bool(number) if kind == BOOL else number


def need_number(value):
    if isinstance(value, (str, bytes, bytearray)) or not hasattr(value, "__float__"):
        raise TypeError(f"a number is expected, not {value!r}")


def encode(kind, value):
    """The 64 bits of a value, as an unsigned integer."""
    need_number(value)
    if kind in (FLOAT, DOUBLE):
        value = float(value)
        if not math.isfinite(value):
            raise ValueError("not a finite number")
        if kind == FLOAT:
            try:
                value = struct.unpack("<f", struct.pack("<f", value))[0]
            except OverflowError:
                raise ValueError("out of the type's range") from None
        return struct.unpack("<Q", struct.pack("<d", value))[0]
    low, high = RANGES[kind]
    number = int(value)
    if number != value or not low <= number <= high:
        raise ValueError(f"a {TYPE_NAMES[kind]} cannot hold {value}")
    return number & 0xFFFFFFFFFFFFFFFF


# --- History: what owsd-recorder kept, by libows-history ---------------------------------------

Recorded = collections.namedtuple("Recorded", "name unit type output decimals")
Records = collections.namedtuple("Records", "time_ns value integer text known quality reason trusted")
Points = collections.namedtuple("Points", "from_ns until_ns min max mean last "
                                "good_ns known_ns count quality worst gap trusted")
Event = collections.namedtuple("Event", "time_ns until_ns name kind reason alarm event value before "
                               "text program person uid pid trusted")
HISTORY_BEGIN, HISTORY_END, HISTORY_GAP, HISTORY_CLOCK, HISTORY_COMMAND, HISTORY_ALARM = range(3, 9)


def _fields(text):
    """Members of a structure: "c_int64 a b; c_uint8 x[3]"."""
    found = []
    for line in text.split(";"):
        kind, *names = line.split()
        for name in names:
            name, _, size = name.rstrip("]").partition("[")
            one = getattr(ctypes, kind)
            if size:
                one = one * int(size)
            found.append((name, one))
    return found


class _Signal(ctypes.Structure):
    _fields_ = _fields("c_char_p name unit; c_uint8 type output; c_int32 decimals; "
                       "c_uint64 spare[4]")


class _Item(ctypes.Structure):
    _fields_ = _fields("c_int64 time_ns boot_ns; c_double number; c_int64 integer; c_void_p text; "
                       "c_uint32 len; c_uint8 known type quality reason trusted; c_uint64 spare[4]")


class _Point(ctypes.Structure):
    _fields_ = _fields("c_int64 from_ns until_ns; c_double min max mean last; "
                       "c_int64 good_ns known_ns; c_uint32 count; c_uint8 quality worst gap "
                       "trusted; c_uint64 spare[4]")


class _Who(ctypes.Structure):
    _fields_ = _fields("c_uint32 serial uid; c_int32 pid; c_char name[32] person[32]")


class _Event(ctypes.Structure):
    _fields_ = _fields("c_int64 time_ns boot_ns until_ns; c_double number before; c_int64 integer "
                       "before_integer; c_int32 signal; c_uint8 kind reason alarm event type "
                       "quality has_before has_after trusted this_boot; c_char text[160]") \
        + [("who", _Who)] + _fields("c_uint64 spare[4]")


def _column(values, dtype):
    """A NumPy array where NumPy is, a list where it is not."""
    try:
        import numpy  # pylint: disable=import-outside-toplevel
    except ImportError:
        return list(values)
    return numpy.array(values, dtype)


class History:
    """What owsd-recorder kept; needs libows-history.so.1, and neither owsd nor the recorder to run.

        with ows.History() as history:
            day = history.points("room1", from_ns, until_ns, 24)
            print(day.min, day.max, day.gap)

    Times are nanoseconds since 1970. Columns are NumPy arrays, or lists where NumPy is not. What
    was not good or is not known is NaN: it belongs in no sum and no line. Raises OSError; KeyError
    for a name that the history does not have. Belongs to one thread at a time."""

    CHUNK = 4096

    def __init__(self, instance="OWS", directory=None):
        self._h = ctypes.c_void_p()
        self._library = ctypes.CDLL("libows-history.so.1")
        self._call("open", instance.encode(), os.fsencode(directory) if directory else None,
                   ctypes.byref(self._h))

    def _call(self, name, *arguments):
        got = getattr(self._library, "ows_history_" + name)(*arguments)
        if got < 0:
            raise OSError(-got, os.strerror(-got))
        return got

    def _ask(self, name, *arguments):
        if not self._h:
            raise ValueError("the history is closed")
        return self._call(name, self._h, *arguments)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        if self._h:
            self._library.ows_history_close.restype = None
            self._library.ows_history_close(self._h)
            self._h = ctypes.c_void_p()

    def refresh(self):
        """See what was written since."""
        self._ask("refresh")

    def _signal(self, index):
        signal = _Signal()
        self._ask("signal", index, ctypes.byref(signal))
        return Recorded(signal.name.decode(), signal.unit.decode("utf-8", "replace"), signal.type,
                        bool(signal.output), signal.decimals)

    def names(self):
        return [self._signal(i).name for i in range(self._ask("signals"))]

    def _index(self, name):
        try:
            return self._ask("find", name.encode())
        except OSError as e:
            if e.errno != errno.ENOENT:
                raise
            raise KeyError(name) from None

    def info(self, name):
        return self._signal(self._index(name))

    def span(self):
        """The first and the last moment of which something is known, or None."""
        begin, end = ctypes.c_int64(), ctypes.c_int64()
        try:
            self._ask("span", ctypes.byref(begin), ctypes.byref(end))
        except OSError as e:
            if e.errno != errno.ENODATA:
                raise
            return None
        return begin.value, end.value

    def records(self, name, from_ns, until_ns):
        """Records of a signal, each of which holds until the next one; the first is what held at
        from_ns. value is NaN where it was not good or is not known, text and integer None."""
        items, rows = (_Item * self.CHUNK)(), []
        self._ask("read", self._index(name), ctypes.c_int64(from_ns), ctypes.c_int64(until_ns))
        while True:
            got = self._ask("next", items, self.CHUNK)
            if not got:
                break
            rows.extend(self._row(item) for item in items[:got])
        columns = list(zip(*rows)) or [()] * len(Records._fields)
        kinds = ("int64", "float64", object, object, "bool", "uint8", "uint8", "bool")
        return Records(*map(_column, columns, kinds))

    @staticmethod
    def _row(item):
        good = item.known and item.quality >= Q_GOOD
        text = None
        if good and item.type == STRING:
            text = ctypes.string_at(item.text, item.len).decode("utf-8", "replace")
        whole = good and item.type not in (FLOAT, DOUBLE, STRING)
        return (item.time_ns, item.number if good else math.nan, item.integer if whole else None,
                text, bool(item.known), item.quality, item.reason, bool(item.trusted))

    def points(self, name, from_ns, until_ns, n):
        """Divide the time into n stretches; a year takes milliseconds. gap: of some of it nothing
        is known, and no line may be drawn through it."""
        points = (_Point * n)()
        self._ask("points", self._index(name), ctypes.c_int64(from_ns), ctypes.c_int64(until_ns),
                  points, n)
        kinds = ["int64"] * 2 + ["float64"] * 4 + ["int64"] * 2 + ["uint32"] + ["uint8"] * 2 \
            + ["bool"] * 2
        return Points(*(_column([getattr(p, field) for p in points], kind)
                        for field, kind in zip(Points._fields, kinds)))

    def events(self, from_ns, until_ns, kinds=()):
        """The journal, as a list: commands, alarms, and what the recorder met (HISTORY_GAP)."""
        event, found = _Event(), []
        self._ask("events", ctypes.c_int64(from_ns), ctypes.c_int64(until_ns),
                  ctypes.c_uint32(sum(1 << kind for kind in set(kinds))))
        while self._ask("next_event", ctypes.byref(event)):
            found.append(self._entry(event))
        return found

    def _entry(self, event):
        whole = event.type not in (FLOAT, DOUBLE, STRING)
        number = event.integer if whole else event.number
        before = event.before_integer if whole else event.before
        command = event.kind == HISTORY_COMMAND
        text = event.text.decode("utf-8", "replace")
        value = (text if event.type == STRING else number) if command else \
            number if event.has_after else None
        return Event(event.time_ns, event.until_ns,
                     self._signal(event.signal).name if event.signal >= 0 else None, event.kind,
                     event.reason, event.alarm, event.event, value,
                     before if event.has_before else None, text,
                     event.who.name.decode("utf-8", "replace"),
                     event.who.person.decode("utf-8", "replace"), event.who.uid, event.who.pid,
                     bool(event.trusted))


def main(arguments):
    instance = "OWS"
    if arguments[:1] == ["-n"] and len(arguments) > 1:
        instance, arguments = arguments[1], arguments[2:]
    if len(arguments) > 2 or arguments[:1] and arguments[0].startswith("-"):
        print("usage: ows.py [-n INSTANCE] [NAME [VALUE]]", file=sys.stderr)
        return 2
    try:
        with Ows(instance, control=len(arguments) == 2) as signals:
            if len(arguments) == 2:
                text = signals.info(arguments[0]).type == STRING
                signals.set(arguments[0], arguments[1] if text else float(arguments[1]))
                return 0
            for name in arguments or signals.names():
                value = signals.get(name)
                shown = int(value.value) if value.type == BOOL else value.value
                quality = "good" if value.good else f"quality 0x{value.quality:02x}"
                print(name, shown, quality, f"{value.age:.1f}s", sep="\t")
    except KeyError as e:
        print(f"no signal {e}", file=sys.stderr)
        return 1
    except (OSError, ValueError) as e:
        print(e, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
