# SPDX-License-Identifier: MIT
"""Read and set the signals of owsd from Python: libows(3), by ctypes.

    import ows

    with ows.Ows() as signals:                    # instance "OWS"
        room = signals["room1"]
        print(room)                               # 21.5 °C, good, 0.3 s old
        if room.good:
            print(room.value + 1)

    with ows.Ows(control=True) as signals:        # needs the right to command
        signals.set("relay", "on")

Names, attributes ("room1_Age") and the meaning of every field are those of libows(3). Reading a
value takes no system call and no lock. An Ows object belongs to one thread at a time, and after a
fork only the parent commands. Times whose name ends in _ns are nanoseconds of CLOCK_BOOTTIME.

What was is read by history() and History, which need libows-history(3).

From a shell:  python3 -m ows [-n INSTANCE] [NAME [VALUE]]
"""

from __future__ import annotations

import ctypes
import difflib
import enum
import errno
import math
import operator
import os
import sys
import time
from typing import Any, Iterator, NamedTuple, NoReturn, Sequence


class Type(enum.IntEnum):
    """The types of signals."""
    BOOL, BYTE, SHORT, LONG, WORD, DWORD, FLOAT, DOUBLE, LARGE, STRING = *range(1, 9), 10, 12


BOOL, BYTE, SHORT, LONG, WORD, DWORD, FLOAT, DOUBLE, LARGE, STRING = Type

# Qualities; Value.text has the words for each
Q_NO_PROPERTY, Q_TYPE, Q_ACCESS, Q_NO_DEVICE, Q_DEVICE = 0x04, 0x05, 0x06, 0x08, 0x0C
Q_SENSOR, Q_STALE, Q_TARGET, Q_SHORT, Q_DIFFERS, Q_INITIAL = 0x10, 0x14, 0x18, 0x19, 0x1C, 0x20
Q_LAST_USABLE = Q_DISABLED = 0x44
Q_NO_OWSD = 0x1A
Q_RANGE, Q_LOW, Q_HIGH, Q_CUT, Q_GOOD = 0x54, 0x55, 0x56, 0x58, 0xC0

DETAIL_SIMULATED, DETAIL_CACHED = 1, 2


class Unarmed(enum.IntEnum):
    """Why a device's alarm does not come: a request that fails, or what the file says."""
    SET = 1       # cannot be armed: SetAlarm is missing or refused
    POR = 2       # cannot be armed: PorAlarm cannot be set to 0
    LATCH = 3     # cannot be read: LatchAlarm
    RESET = 4     # cannot be reset: ResetLatch
    POR_READ = 5  # cannot be read: PorAlarm
    NO_POR = 6    # can do nothing: PorAlarm is not defined
    NO_LATCH = 7  # can do nothing: LatchAlarm is not defined, or empty
    STAYS = 8     # not cleared: the latch stays set, whatever ResetLatch does


KEPT = 256  # entries of each journal

# --- The library --------------------------------------------------------------------------------


def _load(library: str) -> ctypes.CDLL:
    """From the directory of this file, else as the system finds it."""
    beside = os.path.join(os.path.dirname(os.path.abspath(__file__)), library)
    return ctypes.CDLL(beside if os.path.exists(beside) else library)


# A letter for each argument: the handle, int, 64 and 32 bits, double, text, byte, address
_LETTERS = {"h": ctypes.c_void_p, "i": ctypes.c_int, "q": ctypes.c_int64, "u": ctypes.c_uint32,
            "d": ctypes.c_double, "s": ctypes.c_char_p, "b": ctypes.c_uint8, "p": ctypes.c_void_p}


def _declare(library: ctypes.CDLL, prefix: str, functions: str, result: Any = ctypes.c_int) -> None:
    for entry in functions.split():
        name, _, letters = entry.partition(":")
        function = getattr(library, prefix + name)
        function.argtypes, function.restype = [_LETTERS[letter] for letter in letters], result


try:
    _lib = _load("libows.so.1")
except OSError as e:
    raise ImportError(f"ows.py needs the library libows.so.1, package libows1: {e}") from None
_declare(_lib, "ows_", "open_as:sisp reopen:h find:hs get:hiqp get_text:hiqpsu wait:hpq fd:h "
         "changes:hppiq set:hidp set_integer:hiqp set_text:hisp beat:hu for:hs count:h info:hip "
         "origin:hip controller:hip daemon:hqp target:hip target_note:hip device:hip alarm:hup alarm_state:hip "
         "acknowledge:hi shelve:hius command_entry:hup")
_declare(_lib, "ows_", "close:h", None)
_declare(_lib, "ows_", "now:", ctypes.c_int64)
_declare(_lib, "ows_", "alarm_count:h command_count:h", ctypes.c_uint32)
_declare(_lib, "ows_", "quality_text:b reason_text:b limit_state_text:b alarm_kind_text:b "
         "alarm_event_text:b", ctypes.c_char_p)


def _fields(text: str) -> list[tuple[str, Any]]:
    """Members of a structure of the header: "int64 a b; uint8 x[3]". bool: a uint8 of 0 and 1."""
    found = []
    for line in text.split(";"):
        kind, *names = line.split()
        for name in names:
            name, _, size = name.rstrip("]").partition("[")
            one = getattr(ctypes, "c_" + kind) if kind != "by" else _By
            found.append((name, one * int(size) if size else one))
    return found


def _structure(members: str) -> type[ctypes.Structure]:
    return type("Structure", (ctypes.Structure,), {"_fields_": _fields(members)})


_By: Any = _structure("uint32 serial uid; int32 pid; char name[32] person[32]")
_Value = _structure("double number; int64 integer measured_ns tried_ns age_ns; int32 err; "
                    "uint32 count applied len; uint8 type quality detail target")
_Origin = _structure("by who; int64 taken_ns; uint8 reason; bool own; uint64 spare[4]")
_Controller = _structure("by who; int64 joined_ns; uint32 period_ms commands refused; "
                    "bool may_set late; uint64 spare[4]")
_Cursor = _structure("uint32 number start_id generation flags; int64 looked_ns")
_Info = _structure("char_p name path; uint8 type; bool output fresh alarm; uint32 per_factor; "
                   "int64 stale_after_ns; char_p unit description family device calibrated points; "
                   "double scale offset min max limit_hh limit_h limit_l limit_ll filter_s "
                   "deadband; int32 decimals; bool confirm; char_p identity group; uint64 spare[2]")
_Daemon = _structure("int32 pid; uint32 state generation; int64 start_ns beat_age_ns period_ns; "
                     "int alive; uint64 spare[4]")
_Target = _structure("char_p name; uint32 state reconnects group moves; uint64 spare[4]")
_LogLine = _structure("uint32 number level; int64 time_ns; char text[256]; uint64 spare[2]")
_Device = _structure("char_p id family; char identity[48]; int target; uint32 power; "
                     "uint64 answers errors retries wire_us; int64 ok_ns; uint64 wire spare[3]")
_Alarm = _structure("int signal; int64 occurred_ns; double before after; "
                    "int64 before_integer after_integer; uint8 type; bool has_before has_after; "
                    "uint8 kind event quality; char text[64]; by who; uint64 spare[4]")
_AlarmState = _structure("uint32 occurrences; bool item stands polled limits; "
                         "uint8 limit_state limit_kind unarmed; bool shelved; "
                         "int64 since_ns until_ns; by who; char why[64]; uint64 spare[4]")
_Commanded = _structure("int signal; int64 taken_ns; double number; int64 integer; uint32 more; "
                        "uint8 type reason quality; char text[64]; by who; uint64 spare[4]")


# --- What this module returns -------------------------------------------------------------------


class Value(NamedTuple):
    """A value with what belongs to it."""
    value: Any        # bool, int, float or str, by type
    type: int         # a Type
    quality: int      # a Q_..., lowered by age and by a dead owsd
    detail: int       # DETAIL_...
    target: int       # index of the target that served it
    err: int          # 0 or negative errno: of the last read, else of the last write
    measured_ns: int  # 0: never
    tried_ns: int
    age: float        # seconds; before the first value since owsd's start
    count: int        # updates since owsd started
    applied: int      # stamp (see set) of this object's last confirmed command
    data: bytes | None = None  # of a string as it is: value has U+FFFD where it is not UTF-8
    unit: str | None = None

    @property
    def good(self) -> bool:
        return self.quality & 0xC0 == 0xC0

    @property
    def text(self) -> str:
        """The words for the quality: "good", "device absent"."""
        return _lib.ows_quality_text(self.quality).decode()

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        age = f"{self.age:.1f} s old" if self.measured_ns else "never measured"
        return f"{self.value}{unit}, {self.text}, {age}"

    def __repr__(self) -> str:
        return f"<Value {self}>"


class By(NamedTuple):
    """Who did something: uid and pid are the kernel's word, name and person (for whom) the
    program's claims. owsd itself has serial 0."""
    serial: int
    uid: int
    pid: int
    name: str
    person: str


class Info(NamedTuple):
    """What the file says of a signal. None: not given, not known."""
    name: str
    path: str
    type: int
    output: bool
    fresh: bool
    alarm: bool
    per_factor: int
    stale_after_ns: int
    unit: str | None
    description: str | None
    family: str | None
    device: str | None
    calibrated: str | None
    points: str | None  # the text of the file
    decimals: int | None
    scale: float
    offset: float
    min: float | None
    max: float | None
    limit_hh: float | None
    limit_h: float | None
    limit_l: float | None
    limit_ll: float | None
    filter: float
    deadband: float
    confirm: bool
    identity: str    # the path that it began with: the same over a rename or a new device
    group: str | None  # where people look for it


class Origin(NamedTuple):
    """Who gave the command in force, when owsd took it, why, and whether this object gave it."""
    who: By
    taken_ns: int
    reason: str
    own: bool


class Controller(NamedTuple):
    """A connected program."""
    who: By
    joined_ns: int
    period_ms: int  # promised longest time between two beats; 0: none
    commands: int   # taken
    refused: int
    may_set: bool
    late: bool


class Target(NamedTuple):
    """A way to devices. Ways to one wire have the same group, all but one of them suspended."""
    index: int  # as Value.target
    name: str
    state: str
    reconnects: int
    group: int
    moves: int  # signals that came from another target
    note: str | None  # why it is down; while it is up what disturbs it


class Device(NamedTuple):
    """A device that signals name by its ROM id, and what was counted since owsd's start. None: not
    known."""
    id: str | None
    family: str | None
    identity: str | None  # which chip it is by its behaviour
    power: str | None     # "parasite", "external"
    target: int | None    # index of the one that answered last
    answers: int          # of the target, if only an error
    errors: int
    retries: int
    wire_us: int
    ok_ns: int            # last good answer; 0: none


class AlarmEntry(NamedTuple):
    """An entry of the journal of alarms."""
    number: int
    name: str
    occurred_ns: int
    before: Any  # None where there is no value
    after: Any
    kind: str
    event: str
    quality: int
    text: str    # what the latch showed, why it was shelved, or what is refused
    who: By


class CommandEntry(NamedTuple):
    """An entry of the journal of commands."""
    number: int
    name: str
    taken_ns: int
    value: Any  # of a string it may be cut
    reason: str
    quality: int
    more: int   # commands to this signal that were not entered before it
    who: By


class Shelf(NamedTuple):
    since_ns: int
    until_ns: int
    who: By
    why: str


class AlarmState(NamedTuple):
    """How the alarms of a signal stand."""
    occurrences: int  # of the device's alarm since owsd started
    stands: bool      # the device's alarm
    polled: bool      # the bus has no alarm search, owsd reads the item as an input
    limits: bool      # the signal has limit alarms
    limit_state: str
    limit_kind: str
    unarmed: Unarmed | None
    shelf: Shelf | None


TARGET_STATES = ["down", "up", "suspended"]
POWERS = [None, "parasite", "external"]


class Stale(OSError):
    """owsd was restarted or reloaded, or (where something is set) has ended or hangs: reopen()."""

    def __init__(self, *_: Any):
        super().__init__(errno.ESTALE, "owsd has ended, or was restarted or reloaded")


class NotRunning(FileNotFoundError):
    """There is no owsd of that name, or its image is not there yet."""

    def __init__(self, instance: str):
        super().__init__(errno.ENOENT, f"no owsd of the name {instance} runs")

    def __str__(self) -> str:
        return self.strerror


SAYS = {errno.EPROTO: "no segment of owsd, or of another version",
        errno.EROFS: "an input, and Writable is off in the configuration",
        errno.EAGAIN: "no whole sample", errno.EIO: "owsd was killed while it wrote this"}


def _fail(err: int, what: str | None = None) -> NoReturn:
    if err == -errno.ESTALE:
        raise Stale
    kind = PermissionError if err == -errno.EROFS else OSError
    raise kind(-err, SAYS.get(-err) or os.strerror(-err), what)


def _whole(value: Any) -> int:
    """The whole number that it is, of whatever type (NumPy's are no int); of another 2**63."""
    try:
        return operator.index(value)
    except TypeError:
        return 2**63


def _rights(instance: str, control: bool) -> str:
    """What this program has no right to, and who has."""
    h = ctypes.c_void_p()
    if control and _lib.ows_open_as(_bytes(instance), 0, b"ows.py", ctypes.byref(h)) == 0:
        _lib.ows_close(h)
        return (f"no right to set the signals of {instance}: that is for group owsd-control, or "
                "for whom ControlAllow names")
    return f"no right to see the signals of {instance}: that is for group owsd"


def now_ns() -> int:
    """The clock of all times here."""
    return _lib.ows_now()


def _timeout(seconds: float) -> int:
    """In nanoseconds, as libows takes it."""
    return max(0, int(seconds * 1e9)) if seconds < 1e9 else -1


def _bytes(text: str, what: str = "a name") -> bytes:
    if not isinstance(text, str):
        raise TypeError(f"{what} is text, not {text!r}")
    if "\0" in text:
        raise ValueError(f"{what} has no NUL")
    return text.encode()


def _text(raw: bytes) -> str:
    return raw.decode(errors="replace")


def _plain(member: Any) -> Any:
    """A member of a structure, of a type of Python."""
    if isinstance(member, _By):
        return _row(By, member)
    return _text(member) if isinstance(member, bytes) else member


def _row(kind: Any, found: ctypes.Structure, /, **others: Any) -> Any:
    """A tuple of the members of a structure that it has the names of, and of others."""
    return kind(*(others[name] if name in others else _plain(getattr(found, name))
                  for name in kind._fields))


def _number(kind: int, number: float, integer: int) -> Any:
    return number if kind in (FLOAT, DOUBLE) else bool(integer) if kind == BOOL else integer


class Ows:
    """An instance of owsd: its signals by name, like a dictionary that cannot be written into."""

    def __init__(self, instance: str = "OWS", control: bool = False, name: str | None = None):
        """control: to set signals, too. name: of this program, as owsd shows it; without it the
        script's own. Raises NotRunning, PermissionError, OSError as ows_open() of libows(3)."""
        self.instance, self.control = instance, control
        self._h: Any = ctypes.c_void_p()
        self._ids: dict[str, int] = {}
        self._infos: dict[str, Info] = {}
        self._value, self._buffer = _Value(), ctypes.create_string_buffer(256)
        program = name or os.path.basename(sys.argv[0] or "python")
        err = _lib.ows_open_as(_bytes(instance), int(control), _bytes(program),
                               ctypes.byref(self._h))
        if err == -errno.ENOENT:
            raise NotRunning(instance)
        if err == -errno.EACCES:
            raise PermissionError(errno.EACCES, _rights(instance, control))
        if err:
            _fail(err)
        self._read_infos()

    def __enter__(self) -> Ows:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Say goodbye to owsd: what was set stays in force, also if a beat was promised. A program
        that ends without this is lost to owsd."""
        _lib.ows_close(self._h)
        self._h = None

    def __del__(self) -> None:
        # A program that commands and ends in any way but close() is lost to owsd
        if not self.control and self._h:
            self.close()

    def reopen(self) -> None:
        """Map the present image after Stale, and go on as the same program. NotRunning: not there
        yet, try again; what is mapped stays readable."""
        err = _lib.ows_reopen(self._handle())
        if err == -errno.ENOENT:
            raise NotRunning(self.instance)
        if err:
            _fail(err)
        self._read_infos()

    def _handle(self) -> ctypes.c_void_p:
        if not self._h:
            raise ValueError("it is closed")
        return self._h

    def _read_infos(self) -> None:
        found, infos = _Info(), []
        for i in range(_lib.ows_count(self._handle())):
            _lib.ows_info(self._h, i, ctypes.byref(found))
            texts = {name: _text(getattr(found, name)) or None
                     for name in (*Info._fields[8:14], "group")}
            limits = {name: None if math.isnan(getattr(found, name)) else getattr(found, name)
                      for name in Info._fields[17:23]}
            infos.append(_row(Info, found, **texts, **limits, filter=found.filter_s,
                              decimals=found.decimals if found.decimals >= 0 else None))
        self._infos = {info.name: info for info in infos}

    # --- Names ----------------------------------------------------------------------------------

    def find(self, name: str) -> int:
        """The id of a name for ows_get() of libows(3). KeyError: there is none."""
        if name not in self._ids:
            got = _lib.ows_find(self._handle(), _bytes(name))
            if got == -errno.ENOENT:
                raise self._unknown(name)
            if got < 0:
                _fail(got)
            self._ids[name] = got
        return self._ids[name]

    def names(self) -> list[str]:
        """Of all signals, in the order of the file."""
        return list(self._infos)

    def info(self, name: str) -> Info:
        return self._infos[name.removeprefix(self.instance + "__")]

    def __iter__(self) -> Iterator[str]:
        return iter(self.names())

    def __len__(self) -> int:
        return len(self._infos)

    def __contains__(self, name: object) -> bool:
        return name in self._infos

    def __getitem__(self, name: str) -> Value:
        return self.get(name)

    # --- Reading --------------------------------------------------------------------------------

    def get(self, name: str, now: int | None = None) -> Value:
        """The Value of a name. Never raises for a dead or restarted owsd: the value is not good
        then, and stale() or alive() say why. After a reload it stays good for the two seconds in
        which reopen() is due. KeyError: no such name; PermissionError: it is write-only."""
        ident, v = self.find(name), self._value
        now = now or now_ns()
        err = _lib.ows_get(self._handle(), ident, now, ctypes.byref(v))
        while v.type == STRING and err in (0, -errno.ESTALE):
            room = len(self._buffer)
            err = _lib.ows_get_text(self._h, ident, now, ctypes.byref(v), self._buffer, room)
            if v.len < room:
                break
            self._buffer = ctypes.create_string_buffer(v.len + 1)
            err = 0
        if err and err != -errno.ESTALE:
            self._refuse(err, name)
        data = self._buffer.raw[:v.len] if v.type == STRING else None
        info = self._infos.get(name)
        return Value(_number(v.type, v.number, v.integer) if data is None else _text(data), v.type,
                     v.quality, v.detail, v.target, v.err, v.measured_ns, v.tried_ns,
                     v.age_ns / 1e9, v.count, v.applied, data, info.unit if info else None)

    def alive(self, now: int | None = None) -> bool:
        """Is owsd there and its heart beating?"""
        return bool(self._daemon(now)[1].alive)

    def beat_age(self, now: int | None = None) -> float:
        """Seconds since owsd's last heartbeat."""
        return self._daemon(now)[1].beat_age_ns / 1e9

    def stale(self) -> bool:
        """True when reopen() is due: owsd says so in the image, or its heart stands still and the
        name leads to the image of another."""
        return self._daemon()[0] == -errno.ESTALE

    def _daemon(self, now: int | None = None) -> tuple[int, Any]:
        found = _Daemon()
        return _lib.ows_daemon(self._handle(), now or now_ns(), ctypes.byref(found)), found

    def alarms(self, since: int = 0) -> Iterator[AlarmEntry]:
        """The journal of alarms from number `since` on, as far as it is kept. The number after
        the last is where to go on."""
        for number, found in self._journal("alarm", _Alarm, since):
            before, after = (
                _number(found.type, getattr(found, name), getattr(found, name + "_integer"))
                if getattr(found, "has_" + name) else None for name in ("before", "after"))
            yield _row(AlarmEntry, found, number=number, name=self.names()[found.signal],
                       before=before, after=after, kind=_text(_lib.ows_alarm_kind_text(found.kind)),
                       event=_text(_lib.ows_alarm_event_text(found.event)))

    def commands(self, since: int = 0) -> Iterator[CommandEntry]:
        """The journal of commands, likewise."""
        for number, found in self._journal("command", _Commanded, since):
            value = _text(found.text) if found.type == STRING else \
                _number(found.type, found.number, found.integer)
            yield _row(CommandEntry, found, number=number, name=self.names()[found.signal],
                       value=value, reason=_text(_lib.ows_reason_text(found.reason)))

    def _journal(self, kind: str, structure: Any, since: int) -> Iterator[tuple[int, Any]]:
        head = getattr(_lib, f"ows_{kind}_count")(self._handle())
        get = _lib.ows_alarm if kind == "alarm" else _lib.ows_command_entry
        for number in range(max(since, head - KEPT), head):
            found = structure()
            if get(self._handle(), number, ctypes.byref(found)) == 0:
                yield number, found

    def alarm_state(self, name: str) -> AlarmState:
        """How the device's alarm and the limit alarm of a signal stand."""
        found = self._of_signal(_lib.ows_alarm_state, name, _AlarmState())
        return _row(AlarmState, found, unarmed=Unarmed(found.unarmed) if found.unarmed else None,
                    limit_state=_text(_lib.ows_limit_state_text(found.limit_state)),
                    limit_kind=_text(_lib.ows_alarm_kind_text(found.limit_kind)),
                    shelf=_row(Shelf, found) if found.shelved else None)

    def origin(self, name: str) -> Origin:
        """Of the command that is in force for a signal."""
        found = self._of_signal(_lib.ows_origin, name, _Origin())
        return _row(Origin, found, reason=_text(_lib.ows_reason_text(found.reason)))

    def _of_signal(self, call: Any, name: str, found: Any) -> Any:
        err = call(self._handle(), self.find(name), ctypes.byref(found))
        if err and err != -errno.ESTALE:
            self._refuse(err, name)
        return found

    def _each(self, call: Any, structure: Any) -> Iterator[tuple[int, Any]]:
        """What there is by index, without what owsd died in."""
        for index in range(sys.maxsize):
            found = structure()
            err = call(self._handle(), index, ctypes.byref(found))
            if err == -errno.ENOENT:
                return
            if err == 0:
                yield index, found

    def targets(self) -> Iterator[Target]:
        for index, found in self._each(_lib.ows_target, _Target):
            line = _LogLine()
            err = _lib.ows_target_note(self._handle(), index, ctypes.byref(line))
            yield _row(Target, found, index=index, state=TARGET_STATES[min(found.state, 2)],
                       note=None if err else _text(line.text))

    def devices(self) -> Iterator[Device]:
        """What owsd knows of each device that signals name."""
        for _, found in self._each(_lib.ows_device, _Device):
            texts = {name: _text(getattr(found, name)) or None for name in Device._fields[:3]}
            yield _row(Device, found, **texts, power=POWERS[found.power],
                       target=found.target if found.target >= 0 else None)

    def controllers(self) -> Iterator[Controller]:
        """The programs that are connected to owsd."""
        for _, found in self._each(_lib.ows_controller, _Controller):
            if found.who.serial:
                yield _row(Controller, found)

    # --- Waiting --------------------------------------------------------------------------------

    def fileno(self) -> int:
        """A descriptor for select and poll: readable when something is published after this call,
        when owsd has ended, and twice a second, to look whether owsd lives or is back. Call it again
        before each poll, and before the look: that makes it silent. It stays the same until
        close(); do not read it. A reader connects to owsd at the first call."""
        fd = _lib.ows_fd(self._handle())
        if fd == -errno.ENOENT:
            raise NotRunning(self.instance)
        return fd if fd >= 0 else _fail(fd)

    def wait(self, news: int = 0, seconds: float = math.inf) -> int:
        """Sleep until something was published after `news`; returns the new number to hand in next
        time, or the same when the time is over. Raises Stale."""
        number = ctypes.c_uint32(news)
        self._sleep(lambda left: _lib.ows_wait(self._handle(), ctypes.byref(number), left), seconds)
        return number.value

    @staticmethod
    def _sleep(call: Any, seconds: float) -> int:
        """A call that sleeps: Python handles signals in between. -EOVERFLOW is returned."""
        until = time.monotonic() + seconds
        while True:
            got = call(_timeout(until - time.monotonic()))
            if got >= 0 or got == -errno.EOVERFLOW:
                return got
            if got != -errno.EINTR:
                _fail(got)

    def changes(self, seconds: float = math.inf) -> Changes:
        """Follow what changes: an iterator of Changed, which are names of signals. It waits for
        the next change, at most `seconds`, and gives an empty one when they are over. Begins with
        all signals. Raises Stale: reopen(), and go on with the same iterator."""
        return Changes(self, seconds)

    # --- Setting --------------------------------------------------------------------------------

    def set(self, name: str, value: Any) -> int:
        """Command an output or a writable attribute, by a number or by a text as owsctl takes it
        ("on"). Returns the stamp that Value.applied will reach (attributes: 0). TypeError: a number
        for a string; ValueError: the type, its range, Min or Max cannot hold it, or it is no
        number; PermissionError: not writable, or not by this user, with errno EROFS an input whose
        Writable is off in the configuration, with EPERM after a fork; Stale."""
        ident, stamp = self.find(name), ctypes.c_uint32()
        if isinstance(value, str):
            call, value_c = _lib.ows_set_text, _bytes(value, name)
        elif isinstance(value, (bytes, bytearray)) or not hasattr(value, "__float__"):
            raise TypeError(f"{name}: a number or a text is expected, not {value!r}")
        elif -2**63 <= (whole := _whole(value)) < 2**63:
            call, value_c = _lib.ows_set_integer, whole
        else:
            call, value_c = _lib.ows_set, float(value)
        err = call(self._handle(), ident, value_c, ctypes.byref(stamp))
        if err in (-errno.ERANGE, -errno.EINVAL):
            self._refuse_value(name, value)
        if err:
            self._refuse(err, name)
        return stamp.value

    def _refuse_value(self, name: str, value: Any) -> NoReturn:
        info = self._infos.get(name.removeprefix(self.instance + "__"))
        kind = Type(info.type) if info else BOOL
        if kind == STRING and not isinstance(value, str):
            raise TypeError(f"{name} is a string and takes text, not {value!r}")
        limits = [f"{label} {limit:g}" for label, limit in
                  (("Min", info.min), ("Max", info.max)) if limit is not None] if info else []
        raise ValueError(f"{name}: a {kind.name.lower()}{' with ' * bool(limits)}"
                         f"{' and '.join(limits)} cannot hold {value!r}")

    def _unknown(self, name: str) -> KeyError:
        near = difflib.get_close_matches(name, self._infos, 1)
        return KeyError(f"{name}: did you mean {near[0]}?" if near else name)

    def _refuse(self, err: int, name: str) -> NoReturn:
        if err == -errno.ENOENT:
            raise self._unknown(name)
        if err == -errno.ERANGE:
            raise ValueError(f"{name}: out of range")
        _fail(err, name)

    def acknowledge(self, name: str) -> None:
        """Acknowledge the limit alarm of a signal; nothing happens if none is unacknowledged."""
        err = _lib.ows_acknowledge(self._handle(), self.find(name))
        if err:
            self._refuse(err, name)

    def shelve(self, name: str, seconds: int, why: str = "") -> None:
        """Shelve the limit alarm of a signal for so many seconds; 0: unshelve it. Waits until owsd
        has done that, two seconds at most. why: up to 63 bytes."""
        err = _lib.ows_shelve(self._handle(), self.find(name), seconds, _bytes(why, "why"))
        if err:
            self._refuse(err, name)

    def for_person(self, name: str | None) -> None:
        """From now on this object commands for that person: a claim, which owsd shows; up to 31
        bytes. None: for itself. OSError with EBUSY: owsd has still to look at the commands of 16
        other persons."""
        err = _lib.ows_for(self._handle(), _bytes(name or ""))
        if err:
            self._refuse(err, name or "")

    def beat(self, period_ms: int) -> None:
        """Say that this program lives and will say so again within period_ms; if it does not, the
        outputs it set last go to their SafeValue."""
        if not 0 < period_ms <= 3600000:
            raise ValueError("a period is 1 to 3600000 milliseconds")
        err = _lib.ows_beat(self._handle(), period_ms)
        if err:
            _fail(err)


class Changed(list):
    """Names of signals that changed, each once. With everything set they are all signals: at the
    beginning, when the program fell behind, when owsd is lost (all values turned bad) or back."""

    everything = False


class Changes:
    """Made by Ows.changes()."""

    def __init__(self, signals: Ows, seconds: float):
        self.signals, self.seconds, self.cursor = signals, seconds, _Cursor()

    def __iter__(self) -> Changes:
        return self

    def __next__(self) -> Changed:
        signals, n = self.signals, max(1, len(self.signals))
        found = (ctypes.c_int * n)()
        got = signals._sleep(lambda left: _lib.ows_changes(
            signals._handle(), ctypes.byref(self.cursor), found, n, left), self.seconds)
        names = signals.names()
        changed = Changed(names if got < 0 else (names[i] for i in found[:got]))
        changed.everything = got < 0
        return changed


# --- History: what owsd-recorder kept, by libows-history ----------------------------------------


class Recorded(NamedTuple):
    name: str
    unit: str
    type: int
    output: bool
    decimals: int
    identity: str


def _frame(columns: Any) -> Any:
    import pandas  # pylint: disable=import-outside-toplevel
    rows = columns._asdict()
    index = pandas.to_datetime(rows.pop(columns._fields[0]), unit="ns", utc=True)
    return pandas.DataFrame(rows, index=pandas.DatetimeIndex(index, name="time"))


class Records(NamedTuple):
    """Columns."""
    time_ns: Sequence[int]
    value: Sequence[float]
    integer: Sequence[Any]
    text: Sequence[Any]
    known: Sequence[bool]
    quality: Sequence[int]
    reason: Sequence[int]
    trusted: Sequence[bool]

    def frame(self) -> Any:
        """A DataFrame of pandas, by time (UTC)."""
        return _frame(self)


class Points(NamedTuple):
    """Columns."""
    from_ns: Sequence[int]
    until_ns: Sequence[int]
    min: Sequence[float]
    max: Sequence[float]
    mean: Sequence[float]
    last: Sequence[float]
    good_ns: Sequence[int]
    known_ns: Sequence[int]
    count: Sequence[int]
    quality: Sequence[int]
    worst: Sequence[int]
    gap: Sequence[bool]
    trusted: Sequence[bool]

    def frame(self) -> Any:
        """A DataFrame of pandas, by the begin of each stretch (UTC)."""
        return _frame(self)


class Event(NamedTuple):
    time_ns: int
    until_ns: int
    name: str | None
    kind: int  # a HISTORY_...
    reason: int
    alarm: int
    event: int
    value: Any
    before: Any
    text: str
    program: str
    person: str
    uid: int
    pid: int
    trusted: bool


HISTORY_BEGIN, HISTORY_END, HISTORY_GAP, HISTORY_CLOCK, HISTORY_COMMAND, HISTORY_ALARM = range(3, 9)

_Signal = _structure("char_p name unit; uint8 type; bool output; int32 decimals; char_p identity; "
                     "uint64 spare[3]")
_Item = _structure("int64 time_ns boot_ns; double number; int64 integer; void_p text; uint32 len; "
                   "bool known; uint8 type quality reason; bool trusted; uint64 spare[4]")
_Point = _structure("int64 from_ns until_ns; double min max mean last; int64 good_ns known_ns; "
                    "uint32 count; uint8 quality worst; bool gap trusted; uint64 spare[4]")
_Event = _structure("int64 time_ns boot_ns until_ns; double number before; "
                    "int64 integer before_integer; int32 signal; "
                    "uint8 kind reason alarm event type quality; "
                    "bool has_before has_after trusted this_boot; char text[160]; by who; "
                    "uint64 spare[4]")


def _column(values: Any, dtype: Any) -> Any:
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

    def __init__(self, instance: str = "OWS", directory: Any = None):
        self._h: Any = ctypes.c_void_p()
        self._library = _load("libows-history.so.1")
        _declare(self._library, "ows_history_", "open:ssp refresh:h signal:hip signals:h find:hs "
                 "span:hpp read:hiqq next:hpi points:hiqqpi events:hqqu next_event:hp")
        _declare(self._library, "ows_history_", "close:h", None)
        self._call("open", _bytes(instance), os.fsencode(directory) if directory else None,
                   ctypes.byref(self._h))

    def _call(self, name: str, *arguments: Any) -> int:
        got = getattr(self._library, "ows_history_" + name)(*arguments)
        return got if got >= 0 else _fail(got)

    def _ask(self, name: str, *arguments: Any) -> int:
        if not self._h:
            raise ValueError("the history is closed")
        return self._call(name, self._h, *arguments)

    def __enter__(self) -> History:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        if self._h:
            self._library.ows_history_close(self._h)
            self._h = None

    def refresh(self) -> None:
        """See what was written since."""
        self._ask("refresh")

    def _signal(self, index: int) -> Recorded:
        signal = _Signal()
        self._ask("signal", index, ctypes.byref(signal))
        return _row(Recorded, signal)

    def names(self) -> list[str]:
        return [self._signal(i).name for i in range(self._ask("signals"))]

    def _index(self, name: str) -> int:
        try:
            return self._ask("find", _bytes(name))
        except OSError as e:
            if e.errno != errno.ENOENT:
                raise
            raise KeyError(name) from None

    def info(self, name: str) -> Recorded:
        return self._signal(self._index(name))

    def span(self) -> tuple[int, int] | None:
        """The first and the last moment of which something is known, or None."""
        begin, end = ctypes.c_int64(), ctypes.c_int64()
        try:
            self._ask("span", ctypes.byref(begin), ctypes.byref(end))
        except OSError as e:
            if e.errno != errno.ENODATA:
                raise
            return None
        return begin.value, end.value

    def records(self, name: str, from_ns: int, until_ns: int) -> Records:
        """Records of a signal, each of which holds until the next one; the first is what held at
        from_ns. value is NaN where it was not good or is not known, text and integer None."""
        items, rows = (_Item * self.CHUNK)(), []
        self._ask("read", self._index(name), from_ns, until_ns)
        while got := self._ask("next", items, self.CHUNK):
            rows.extend(self._item(item) for item in items[:got])
        columns = list(zip(*rows)) or [()] * len(Records._fields)
        kinds = ("int64", "float64", object, object, "bool", "uint8", "uint8", "bool")
        return Records(*map(_column, columns, kinds))

    @staticmethod
    def _item(item: Any) -> Records:
        good = item.known and item.quality >= Q_GOOD
        text = None
        if good and item.type == STRING:
            text = _text(ctypes.string_at(item.text, item.len))
        whole = good and item.type not in (FLOAT, DOUBLE, STRING)
        return _row(Records, item, value=item.number if good else math.nan,
                    integer=item.integer if whole else None, text=text)

    def points(self, name: str, from_ns: int, until_ns: int, n: int) -> Points:
        """Divide the time into n stretches; a year takes milliseconds. gap: of some of it nothing
        is known, and no line may be drawn through it."""
        points = (_Point * n)()
        self._ask("points", self._index(name), from_ns, until_ns, points, n)
        kinds = ["int64"] * 2 + ["float64"] * 4 + ["int64"] * 2 + ["uint32"] + ["uint8"] * 2 \
            + ["bool"] * 2
        return Points(*(_column([getattr(p, field) for p in points], kind)
                        for field, kind in zip(Points._fields, kinds)))

    def events(self, from_ns: int, until_ns: int, kinds: Sequence[int] = ()) -> list[Event]:
        """The journal: commands, alarms, and what the recorder met (HISTORY_GAP)."""
        event, found = _Event(), []
        self._ask("events", from_ns, until_ns, sum(1 << kind for kind in set(kinds)))
        while self._ask("next_event", ctypes.byref(event)):
            found.append(self._entry(event))
        return found

    def _entry(self, event: Any) -> Event:
        whole = event.type not in (FLOAT, DOUBLE, STRING)
        value = event.integer if whole else event.number
        command = event.kind == HISTORY_COMMAND
        if command and event.type == STRING:
            value = _text(event.text)
        before = event.before_integer if whole else event.before
        who = _row(By, event.who)
        return _row(Event, event, program=who.name, person=who.person, uid=who.uid, pid=who.pid,
                    name=self._signal(event.signal).name if event.signal >= 0 else None,
                    value=value if command or event.has_after else None,
                    before=before if event.has_before else None)


def history(name: str, since: float = 86400.0, until: float = 0.0, n: int = 0, *,
            instance: str = "OWS", directory: Any = None) -> Any:
    """What a signal had from so many seconds ago until so many: Records, or, with n, Points.

        print(ows.history("room1").value)
        ows.history("room1", since=365 * 86400, n=500).frame().plot(y=["min", "mean", "max"])
    """
    now = time.time_ns()
    begin, end = (max(0, now - int(ago * 10**9)) for ago in (since, until))
    with History(instance, directory) as past:
        return past.points(name, begin, end, n) if n else past.records(name, begin, end)


def main(arguments: list[str]) -> int:
    instance = "OWS"
    if arguments[:1] == ["-n"] and len(arguments) > 1:
        instance, arguments = arguments[1], arguments[2:]
    if len(arguments) > 2 or arguments[:1] and arguments[0].startswith("-"):
        print("usage: ows.py [-n INSTANCE] [NAME [VALUE]]", file=sys.stderr)
        return 2
    try:
        with Ows(instance, control=len(arguments) == 2) as signals:
            if len(arguments) == 2:
                signals.set(*arguments)
                return 0
            for name in arguments or signals:
                value = signals[name]
                known = value.good or value.measured_ns
                shown = "-" if not known else int(value.value) if value.type == BOOL else value.value
                print(name, shown, value.text, f"{value.age:.1f}s", sep="\t")
    except KeyError as e:
        print(f"no signal {e}", file=sys.stderr)
        return 1
    except (OSError, ValueError) as e:
        print(e, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
