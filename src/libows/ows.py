# SPDX-License-Identifier: MIT
"""Read and set the signals of owsd from Python: one file, nothing to build.

    import ows

    with ows.Ows() as signals:                    # instance "OWS"
        room = signals.get("room1")
        if room.good:
            print(room.value, "measured", room.age, "s ago")

    with ows.Ows(control=True) as signals:        # needs the right to command
        signals.set("relay", True)

Names, attributes ("room1_Age") and the meaning of every field are those of libows(3). A read takes
no system call and no lock; each is verified by its check word. Python has no atomic operations,
so what a set does to shared memory is arranged to do no harm to other consumers (see "Without
atomic operations" in shared-memory.md). An Ows object belongs to one thread at a time.

From a shell:  python3 ows.py [-n INSTANCE] [NAME [VALUE]]
"""

import collections
import ctypes
import errno
import math
import mmap
import os
import platform
import pwd
import stat
import struct
import sys
import time

MAJOR = 1
IMAGE_MAGIC, COMMAND_MAGIC = 0x4953574F, 0x4353574F
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
RECORD_SIZE, INFO_SIZE, SLOT_SIZE, ENTRY_SIZE, CLIENT_SIZE, CLIENTS = 256, 64, 32, 16, 32, 32
WHOLE_TRIES = 64
OUTPUT, FRESH, ALARM, NO_SET = 1, 2, 4, 8
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
]
ATTRIBUTE = {a[0]: a for a in ATTRIBUTES}
DRIVER = {"_DGNRESET": (BOOL, False, True), "_TRANSACTIONS": (LARGE, True, False),
          "_RECONNECTS": (LARGE, True, False)}

# One slot: the sample's 48 bytes and the attributes' 72
SAMPLE = struct.Struct("<8sqqiBBBBIIII")
ATTRS = struct.Struct("<QqqqIIIIIIIBB6xI")
Attrs = collections.namedtuple("Attrs", "transactions update_ns age_max_ns commanded per_base "
                               "per_max pend_base pend_last pend_max alarms flags limit_state "
                               "limit_condition check")
Header = collections.namedtuple(
    "Header", "magic major minor size generation state pid start_id alarm_off start_ns "
    "start_wall_ns period_ns alarm_size alarm_count record_off record_size record_count info_off "
    "info_size name_off target_off target_size target_count counter_off counter_size "
    "counter_count pool_off pool_size text_off text_size")
HEADER = struct.Struct("<IHHIIIiIIqqqIIIIIIIIIIIIIIIIII")
ALARM_ENTRY = struct.Struct("<IIq8s8sBBBB20sII")
CommandHeader = collections.namedtuple(
    "CommandHeader", "magic major minor size generation state pid start_id slot_off slot_size "
    "slot_count entry_off entry_size dirty_off dirty_words client_off client_size pool_off "
    "pool_size text_off text_size text_cap ack_off")
COMMAND_HEADER = struct.Struct("<IHHIIIiIIIIIIIIIIIIIIII")
STATE_OFF, NEWS_OFF, ALARM_HEAD_OFF, BELL_OFF = 16, 128, 132, 128
# How often the names of segments are looked at while owsd's heart stands still
ORPHAN_LOOK_NS = 1_000_000_000


class Stale(OSError):
    """owsd was restarted or reloaded: call reopen()."""

    def __init__(self):
        super().__init__(errno.ESTALE, "owsd was restarted or reloaded")


class Value(collections.namedtuple("Value", "value type quality detail target err measured_ns "
                                   "tried_ns age count applied data", defaults=[None])):
    """A value with what belongs to it; age in seconds, before the first value since the start.
    data: the bytes of a string as they are, of which value has U+FFFD where they are not UTF-8;
    None for all other types."""

    @property
    def good(self):
        return self.quality & 0xC0 == 0xC0


ALARM_KINDS = ["none", "device", "power-on reset", "high high", "high", "low", "low low", "stale",
               "bad"]
LIMIT_STATES = ["normal", "unacknowledged", "acknowledged", "returned to normal unacknowledged"]
ALARM_EVENTS = ["unknown", "raised", "returned", "acknowledged"]
# before and after: None where there is no value; kind and event: words
AlarmEntry = collections.namedtuple("AlarmEntry", "number name occurred_ns before after kind event "
                                    "quality latch")

# How the alarms of a signal stand: occurrences of the device's alarm since owsd started, whether it
# stands, whether the item is read as an input for want of an alarm search; limit alarms in words;
# whether the device's alarm cannot be armed
AlarmState = collections.namedtuple("AlarmState", "occurrences stands polled limits limit_state "
                                    "limit_kind unarmed")

# A way to devices; ways to one wire have the same group, all but one of them suspended; moves:
# signals that came from another target. The index is what Value.target says
Target = collections.namedtuple("Target", "index name state reconnects group moves")
TARGET = struct.Struct("<104sIIII8x")
TARGET_STATES = ["down", "up", "suspended"]

Info = collections.namedtuple("Info", "name path type output fresh alarm per_factor "
                              "stale_after_ns")


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

    def wake(self, address):
        if self.number is not None:
            self.syscall(ctypes.c_long(self.number), ctypes.c_void_p(address), ctypes.c_long(1),
                         ctypes.c_long(1), None, None, ctypes.c_long(0))

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


class Segment:
    """One mapped file: its bytes, and its words as single 32- and 64-bit loads and stores."""

    def __init__(self, instance, kind, writable):
        self.path = path = f"/dev/shm/owsd.{instance}.{kind}"
        self.fd = os.open(path, (os.O_RDWR if writable else os.O_RDONLY) | os.O_NOFOLLOW |
                          os.O_CLOEXEC | os.O_NONBLOCK)
        self.memory = self.words = self.doubles = None
        try:
            status = os.fstat(self.fd)
            if not stat.S_ISREG(status.st_mode) or not trusted(status.st_uid):
                raise PermissionError(errno.EPERM, "belongs to another user", path)
            if status.st_size < 256 or status.st_size % 8:
                raise broken()
            self.size, self.file = status.st_size, (status.st_dev, status.st_ino)
            self.memory = mmap.mmap(self.fd, self.size, mmap.MAP_SHARED,
                                    mmap.PROT_READ | (mmap.PROT_WRITE if writable else 0))
            self.words = memoryview(self.memory).cast("I")
            self.doubles = memoryview(self.memory).cast("Q")
            self.address = Futex.address(self.memory)
        except BaseException:
            self.close()
            raise

    def word(self, offset):
        return self.words[offset >> 2]

    def string(self, offset, start, size):
        """A text of the pool; "" for an offset that is none."""
        if not start <= offset < start + size:
            return ""
        end = self.memory.find(b"\0", offset, start + size)
        return self.memory[offset:end].decode(errors="replace") if end >= 0 else ""

    def replaced(self):
        """Does its name lead to another file? One that is gone leads nowhere yet."""
        try:
            there = os.lstat(self.path)
        except OSError:
            return False
        return (there.st_dev, there.st_ino) != self.file

    def inside(self, offset, count, size):
        if offset % 8 or offset + count * size > self.size:
            raise broken()

    def close(self):
        for view in (self.words, self.doubles, self.memory):
            if view is not None:
                view.release() if isinstance(view, memoryview) else view.close()
        self.words = self.doubles = self.memory = None
        if self.fd >= 0:
            os.close(self.fd)
        self.fd = -1


def trusted(uid):
    if uid in (0, os.geteuid()):
        return True
    try:
        return uid == pwd.getpwnam("owsd").pw_uid
    except KeyError:
        return False


def broken():
    return OSError(errno.EPROTO, "no segment of owsd, or of another layout")


class Ows:
    """An instance of owsd. All times are nanoseconds of CLOCK_BOOTTIME where the name says _ns."""

    def __init__(self, instance="OWS", control=False):
        self.instance, self.control = instance, control
        self.image = self.command = None
        self.seen_alarms, self.levels = {}, {}
        self.client = None
        self.futex = Futex()
        self._open()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # --- Opening --------------------------------------------------------------------------------

    def _open(self):
        image = command = None
        try:
            image = Segment(self.instance, "image", False)
            header = self._check_image(image)
            if self.control:
                command = Segment(self.instance, "command", True)
                command_header = self._check_command(command, header)
        except BaseException:
            for segment in (image, command):
                if segment is not None:
                    segment.close()
            raise
        restarted = self.image is not None and header.start_ns != self.header.start_ns
        self._drop()
        self.image, self.header = image, header
        self.command, self.command_header = command, command_header if command else None
        self.dead_after_ns = max(2_000_000_000, 3 * header.period_ns)
        self.looked_ns, self.orphan = None, False
        if restarted:
            self.seen_alarms.clear()
        self._read_table()
        if self.client is not None and self._client_word(0) != os.getpid():
            self.client = None
        if self.client is not None:  # a new owsd repeats our commands when it hears us
            self._set_client_word(4, self._client_word(4) + 1)

    @staticmethod
    def _check_image(image):
        header = Header(*HEADER.unpack_from(image.memory))
        if (header.magic, header.major, header.size) != (IMAGE_MAGIC, MAJOR, image.size) or \
           header.record_count == 0:
            raise broken()
        # A later minor version may have larger entries
        for size, least in ((header.record_size, RECORD_SIZE), (header.info_size, INFO_SIZE),
                            (header.target_size, TARGET.size),
                            (header.alarm_size, ALARM_ENTRY.size if header.alarm_count else 0)):
            if size < least or size % 8:
                raise broken()
        for offset, count, size in ((header.record_off, header.record_count, header.record_size),
                                    (header.info_off, header.record_count, header.info_size),
                                    (header.pool_off, header.pool_size, 1),
                                    (header.text_off, header.text_size, 1),
                                    (header.target_off, header.target_count, header.target_size),
                                    (header.alarm_off, header.alarm_count, header.alarm_size)):
            image.inside(offset, count, size)
        return header

    @staticmethod
    def _check_command(command, image_header):
        h = CommandHeader(*COMMAND_HEADER.unpack_from(command.memory))
        if (h.magic, h.major, h.size) != (COMMAND_MAGIC, MAJOR, command.size) or \
           (h.slot_size, h.entry_size, h.client_size) != (SLOT_SIZE, ENTRY_SIZE, CLIENT_SIZE):
            raise broken()
        if (h.generation, h.start_id) != (image_header.generation, image_header.start_id):
            raise FileNotFoundError(errno.ENOENT, "the command segment is just being replaced")
        if h.slot_count != image_header.record_count:
            raise broken()
        for offset, count, size in ((h.slot_off, h.slot_count, SLOT_SIZE),
                                    (h.entry_off, h.slot_count, ENTRY_SIZE),
                                    (h.dirty_off, (h.slot_count + 31) // 32, 4),
                                    (h.ack_off, h.slot_count, 4),
                                    (h.client_off, CLIENTS, CLIENT_SIZE)):
            command.inside(offset, count, size)
        return h

    def _read_table(self):
        """What does not change while a generation lives."""
        h, image = self.header, self.image
        self.records, self.table = {}, []
        for record in range(h.record_count):
            name, path, factor, _, stale = struct.unpack_from(
                "<IIIIq", image.memory, h.info_off + record * h.info_size)
            text_off, kind, flags, text_cap = struct.unpack_from(
                "<IBBH", image.memory, h.record_off + record * h.record_size + 4)
            if text_cap and not h.text_off <= text_off <= h.text_off + h.text_size - 2 * text_cap:
                raise broken()
            name = image.string(name, h.pool_off, h.pool_size)
            path = image.string(path, h.pool_off, h.pool_size)
            self.table.append((Info(name, path, kind, bool(flags & OUTPUT), bool(flags & FRESH),
                                    bool(flags & ALARM), factor, stale), text_off, text_cap,
                               bool(flags & NO_SET)))
            if record > 0:
                self.records[name] = record

    def _drop(self):
        for segment in (self.image, self.command):
            if segment is not None:
                segment.close()
        self.image = self.command = None

    def close(self):
        if self.client is not None and self._client_word(0) == os.getpid():
            # its commands stay, but not as those of the program that takes its place next
            for record in range(self.command_header.slot_count):
                at = (self.command_header.slot_off + record * SLOT_SIZE + 12) >> 2
                if self.command.words[at] == self.client + 1:
                    self.command.words[at] = 0
            self._set_client_word(0, 0)
        self.client = None
        self._drop()

    def reopen(self):
        """Map the present segments after Stale. FileNotFoundError: not there yet, try again; what
        is mapped stays readable."""
        probe = Segment(self.instance, "image", False)
        try:
            if probe.word(STATE_OFF) != LIVE:
                raise FileNotFoundError(errno.ENOENT, "the new image is not there yet")
        finally:
            probe.close()
        self._open()

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
        base = self.header.record_off + record * self.header.record_size
        _, text_off, text_cap, _ = self.table[record]
        for _ in range(WHOLE_TRIES):
            seq = words[base >> 2]
            half = seq >> 1 & 1
            raw = memory[base + 16 + 120 * half:base + 136 + 120 * half]
            text = memory[text_off + half * text_cap:text_off + (half + 1) * text_cap] \
                if want_text else b""
            if (words[base >> 2] - (seq & ~1)) & 0xFFFFFFFF > 2:
                continue
            both = struct.unpack("<30I", raw)
            # A record that was never published is zero, and so are its check words
            if seq >= 2 and (check(both[:11]) != both[11] or check(both[12:29]) != both[29]):
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
        """Of an owsd that was killed when its segments had lost their names, so that the one after
        it cannot say anything in them. Looks once a second, and only while the heart stands."""
        now = now_ns()
        if self.looked_ns is None or now - self.looked_ns >= ORPHAN_LOOK_NS:
            self.looked_ns = now
            self.orphan = not self._beats(now) and (
                self.image.replaced() or self.command is not None and self.command.replaced())
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
        raw, measured, tried, err, quality, detail, target, _, count, applied, length, _ = sample
        age = max(0, now - (measured or self.header.start_ns))
        if attribute != "_Value" or record == 0:
            kind, readable = self._kind(record, attribute)
            if not readable:
                raise PermissionError(errno.EACCES, "write-only", name)
            value, quality = self._attribute(record, attribute, sample, attrs, age), Q_GOOD
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
            elif attribute == "_Value" and record and 0 < info.stale_after_ns < age:
                quality = Q_STALE
        return Value(value, kind, quality, detail, target, err, measured, tried, age / 1e9, count,
                     applied, data)

    @staticmethod
    def _kind(record, attribute):
        if record == 0:
            return DRIVER[attribute][0], DRIVER[attribute][1]
        return ATTRIBUTE[attribute][2], ATTRIBUTE[attribute][3]

    def _attribute(self, record, attribute, sample, attrs, age_ns):
        info = self.table[record][0]
        if attribute == "_RECONNECTS":
            return decode(LARGE, sample[0])
        if attribute == "_Alarm":
            seen = self.seen_alarms.get(info.name, 0)
            self.seen_alarms[info.name] = attrs.alarms
            return attrs.alarms != seen
        period = self._slot(0)[1].per_base
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
        h = self.header
        head = self.image.word(ALARM_HEAD_OFF)
        first = max(since, head - h.alarm_count)
        for number in range(first, head):
            entry = self._alarm(number)
            if entry is not None:
                yield entry

    def _alarm(self, number):
        h, memory = self.header, self.image.memory
        at = h.alarm_off + number % h.alarm_count * h.alarm_size
        for _ in range(WHOLE_TRIES):
            raw = memory[at:at + ALARM_ENTRY.size]
            words = struct.unpack("<16I", raw)
            if words[0] % 2 == 0 and check(words[1:15]) == words[15]:
                break
        else:
            return None
        (_, record, occurred, before, after, kind, event, quality, flags, latch, there,
         _) = ALARM_ENTRY.unpack(raw)
        if there != number or not 0 < record < len(self.table):
            return None
        info = self.table[record][0]
        return AlarmEntry(number, info.name, occurred,
                          decode(info.type, before) if flags & 1 else None,
                          decode(info.type, after) if flags & 2 else None,
                          word(ALARM_KINDS, kind, "none"), word(ALARM_EVENTS, event, "unknown"),
                          quality, latch.rstrip(b"\0").decode(errors="replace"))

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
                          bool(attrs.flags & ALARM_UNARMED))

    def targets(self):
        """All targets: Target by Target."""
        h = self.header
        for index in range(h.target_count):
            name, state, reconnects, group, moves = TARGET.unpack_from(
                self.image.memory, h.target_off + index * h.target_size)
            yield Target(index, name.split(b"\0")[0].decode(errors="replace"),
                         word(TARGET_STATES, state, "unknown"), reconnects, group, moves)

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
            self.futex.wait(self.image.address + NEWS_OFF, now, min(left, 1))

    # --- Setting --------------------------------------------------------------------------------

    def set(self, name, value):
        """Command an output or a writable attribute. Returns the stamp that Value.applied will
        reach (attributes: 0). TypeError: text where a number is expected, or the other way
        round; ValueError: the type cannot hold it; PermissionError: not writable, with errno
        EROFS an input whose Writable is off in the configuration;
        BlockingIOError: another program is just writing this text; Stale."""
        record, attribute = self.find(name)
        if self.command is None:
            raise PermissionError(errno.EACCES, "opened without control", name)
        if self.table[record][3] and attribute in ("_Value", "_WriteEnable", "_WriteOneShot"):
            raise PermissionError(errno.EROFS, "an input, and Writable is off", name)
        self._there()
        slot = self.command_header.slot_off + record * SLOT_SIZE
        if attribute == "_Value" and record:
            stamp = self._set_signal(record, slot, name, value)
        else:
            stamp = 0
            need_number(value)
            self._set_flag(record, attribute, slot, name, bool(value))
        self._ring(record)
        return stamp

    def acknowledge(self, name):
        """Acknowledge the limit alarm of a signal; nothing happens if none is unacknowledged."""
        record, _ = self.find(name)
        if record == 0:
            raise KeyError(name)
        if self.command is None:
            raise PermissionError(errno.EACCES, "opened without control", name)
        if not self.command_header.ack_off:
            raise OSError(errno.EOPNOTSUPP, "owsd is of a version without limit alarms")
        self._there()
        at = (self.command_header.ack_off >> 2) + record
        self.command.words[at] = self.command.words[at] + 1 & 0xFFFFFFFF
        self._ring(record)

    def _there(self):
        """Another consumer may have truncated the file, and touching it then is a fatal signal.
        Nobody takes what is set in a segment whose owsd has stopped, or that was replaced."""
        if os.fstat(self.command.fd).st_size < self.command.size:
            raise Stale
        if self.command.word(STATE_OFF) != LIVE:
            raise Stale

    def _set_signal(self, record, slot, name, value):
        info, words = self.table[record][0], self.command.words
        writable = info.output or words[slot + 20 >> 2] == 2 or \
            self._slot(record)[1].flags & WRITE_ENABLE
        if not writable:
            raise PermissionError(errno.EACCES, "not writable", name)
        if info.type == STRING:
            if not isinstance(value, str):
                raise TypeError(f"{name} is a string and takes text, not {value!r}")
            self._set_text(record, value.encode())
        else:
            self.command.doubles[slot >> 3] = encode(info.type, value)
        mine = self.client is not None and self._client_word(0) == os.getpid()
        words[slot + 12 >> 2] = self.client + 1 if mine else 0
        stamp = words[slot + 8 >> 2] + 1 & 0xFFFFFFFF or 1
        words[slot + 8 >> 2] = stamp
        return stamp

    def _set_text(self, record, text):
        h, command = self.command_header, self.command
        offset = command.word(h.entry_off + record * ENTRY_SIZE + 12)
        if len(text) > h.text_cap or b"\0" in text:
            raise ValueError("longer than the room in the layout, or with a NUL")
        if offset == 0 or offset % 4 or offset + 16 + h.text_cap > command.size:
            raise broken()
        words, at = command.words, offset >> 2
        if words[at]:
            raise BlockingIOError(errno.EBUSY, "another program is just writing it")
        words[at] = os.getpid()
        words[at + 1] = len(text)
        command.memory[offset + 16:offset + 16 + len(text)] = text
        words[at + 2] = check_bytes(text)
        words[at] = 0

    def _set_flag(self, record, attribute, slot, name, on):
        writable = DRIVER[attribute][2] if record == 0 else ATTRIBUTE[attribute][4]
        if not writable:
            raise PermissionError(errno.EACCES, "not writable", name)
        words = self.command.words
        if attribute in ("_ReadEnable", "_WriteEnable"):
            words[slot + (16 if attribute == "_ReadEnable" else 20) >> 2] = 2 if on else 1
            return
        key = self.table[record][0].name, attribute
        if on and not self.levels.get(key, False):
            at = slot + (24 if attribute == "_WriteOneShot" else 28) >> 2
            words[at] = words[at] + 1 & 0xFFFFFFFF
        self.levels[key] = on

    def _ring(self, record):
        words = self.command.words
        # All 32 marks of the word, for setting one could take away another consumer's
        words[(self.command_header.dirty_off >> 2) + record // 32] = 0xFFFFFFFF
        words[BELL_OFF >> 2] = words[BELL_OFF >> 2] + 0x10001 & 0xFFFFFFFF
        self.futex.wake(self.command.address + BELL_OFF)
        self._found_by_owsd()

    def _found_by_owsd(self):
        if self.command.word(STATE_OFF) != LIVE or self._is_orphan():
            raise Stale

    def _client_word(self, offset):
        return self.command.word(self.command_header.client_off + self.client * CLIENT_SIZE +
                                 offset)

    def _set_client_word(self, offset, value):
        at = self.command_header.client_off + self.client * CLIENT_SIZE + offset
        self.command.words[at >> 2] = value & 0xFFFFFFFF

    def beat(self, period_ms):
        """Say that this program lives and will say so again within period_ms; if it does not, the
        outputs it set last go to their SafeValue."""
        if self.command is None:
            raise PermissionError(errno.EACCES, "opened without control")
        self._there()
        if self.client is not None and self._client_word(0) != os.getpid():
            self.client = None
        if self.client is None:
            for self.client in range(CLIENTS):
                if self._client_word(0) == 0:
                    self._set_client_word(0, os.getpid())
                    break
            else:
                self.client = None
                raise OSError(errno.ENOSPC, "the table of clients is full")
        self._set_client_word(8, period_ms)
        self._set_client_word(4, self._client_word(4) + 1)
        self._found_by_owsd()


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
