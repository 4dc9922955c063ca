/* SPDX-License-Identifier: MIT */
/*
 * The words of owsd for what is wrong, once for C, the page's script and the documentation
 * (tests/lint/words.py, which compares them, and with --write copies them). No guard: each
 * includer defines QUALITY, ERROR and ALARM.
 *
 * QUALITY(code, health, word, cause, remedy): a quality of ows.h that is not good, and what it says
 * of the chip (enum device_health).
 * ERROR(errno, word, remedy): an error of the bus contract (hal/bus/bus.h) or of libows. Its word
 * is the cause. It is printed as "word: remedy".
 *
 * ALARM(kind, event, word, cause, remedy): an alarm of a device, which no limit explains.
 *
 * A cause is what owsd has seen, and no more. A remedy says what to look at or to do.
 */

/* clang-format off */
QUALITY(NO_PROPERTY, FAILURE, "no such property", "The device has no property of that name.",
        "Check the spelling of the path. \"owsctl dir\" lists what the device has.")
QUALITY(TYPE, FAILURE, "wrong type",
        "The type of the signal does not fit the property.",
        "Take the type that the log names. Lists (.ALL) and texts take string.")
QUALITY(ACCESS, FAILURE, "access refused",
        "The property is read-only or write-only, or owsd has no permission.",
        "Make the item an input, or an output without Readable. Else look at the owserver's "
        "option readonly, or the rights of the kernel's files.")
QUALITY(NO_DEVICE, FAILURE, "device absent", "The device does not answer on its wire.",
        "Does \"owsctl scan\" list the id? Compare it with the path. Check ground, data and the "
        "pull-up.")
QUALITY(DEVICE, FAILURE, "device error",
        "The answer is late, fails its checksum or is out of the chip's range, or the device "
        "reports a fault.",
        "Look for a bad contact, a long wire without enough pull-up, or noise. \"owsctl read\" of "
        "the path shows the answer.")
QUALITY(SENSOR, FAILURE, "sensor power fault",
        "The sensor answers as one without supply: a thermometer reads 85 or 127.94 °C.",
        "Check its supply. Parasite power over a long wire needs a strong pull-up.")
QUALITY(STALE, FAILURE, "stale", "No newer value came within StaleAfter.",
        "Is the target up? _ReadEnable or PerFactor may hold the signal back.")
QUALITY(TARGET, FAILURE, "target down",
        "The target, or one of its bridge chips, does not answer.",
        "Does owserver run at that port? Is the bridge chip at its address? owsd tries again by "
        "itself.")
QUALITY(SHORT, FAILURE, "wire short", "The data line is held at ground.",
        "Unplug branches until the wire lives again.")
QUALITY(NO_OWSD, CHECK, "owsd not running",
        "owsd has ended or hangs.",
        "Does the service run: systemctl status owsd@*?")
QUALITY(DIFFERS, FAILURE, "not as commanded", "The output reads otherwise than it was written.",
        "Did the device lose its supply, or did another program switch it? Set it again, or let "
        "Restore do so.")
QUALITY(INITIAL, CHECK, "initial", "The signal was never read or written.",
        "An input has its first value soon. Set an output, or give it an InitValue.")
QUALITY(LAST_USABLE, CHECK, "last usable value",
        "Reading is disabled, another target has not answered yet, readings jump beyond MaxStep, "
        "or an output was not read or written since its target or its device was away.",
        "Wait for the new target, set _ReadEnable to 1, or raise MaxStep; set the output, or give it "
        "ReadBack.")
QUALITY(RANGE, OFF_SPEC, "out of range", "The value is beyond Min or Max.",
        "Is the sensor or its wire broken? Else correct Min and Max.")
QUALITY(LOW, OFF_SPEC, "at lower limit",
        "The value is held at the lower end of its type or of Points.",
        "Take a wider type, or continue Points.")
QUALITY(HIGH, OFF_SPEC, "at upper limit",
        "The value is held at the upper end of its type or of Points.",
        "Take a wider type, or continue Points.")
QUALITY(CUT, OFF_SPEC, "cut", "The text is longer than its room.", "Read a part of it.")

/* What a device reports by itself. */
ALARM(DEVICE, RAISED, "device alarm", "What the device watches has happened.",
      "Look at what it watches. The alarm ends when owsd can clear its latch.")
ALARM(DEVICE, FAILED, "device alarm does not work",
      "The device's own alarm does not come.",
      "Correct the key that \"owsctl alarms\" names. The log has the property.")
ALARM(POR, RAISED, "power-on reset", "The device lost its power and started again.",
      "If it comes again look at supply and contacts. owsd writes the outputs again.")

/* What a path can be wrong in. */
ERROR(ENODEV, "no such device there",
      "does owsctl scan list the id? Compare it with the path; check plug and cable")
ERROR(ENOENT, "no such property", "check its spelling; owsctl dir shows what a device has")
ERROR(EISDIR, "it is a directory", "owsctl dir shows the properties in it")
ERROR(ENOTDIR, "it is no directory", "owsctl read shows its value")
ERROR(EILSEQ, "the answer is not a value of this type",
      "choose another Type; string takes any text")
ERROR(EMSGSIZE, "the answer is longer than the room for it",
      "choose a property that answers less")
ERROR(EACCES, "it can only be read, or only be written",
      "IO input reads it; IO output without Readable writes it")
ERROR(EBADRQC, "SetAlarm is not defined, or has no '='", "write SetAlarm \"property=value\"")
ERROR(EUCLEAN, "it is still set after 0 was written",
      "does what sets it last? owsctl read shows the input")
ERROR(ENXIO, "not found, and a bridge chip of the target does not answer",
      "look at its supply, SDA, SCL")
ERROR(EPERM, "no permission",
      "a read-only server, or ControlAllow, refuses the write; a file of the kernel needs root or "
      "a udev rule")
/* What happens on the way. */
ERROR(EINVAL, "the target refuses this value", "write a value that the property takes")
ERROR(EBADMSG, "wrong checksum", "look for a bad contact, a weak pull-up, or noise")
ERROR(ENOMSG, "nothing but ones or zeros",
      "the wire gives them without a chip: look at its supply, its contact, the pull-up")
ERROR(EBADE, "nothing proves the answer",
      "look for a bad contact, a weak pull-up, or noise, or a copy of a chip that does less")
ERROR(EMEDIUMTYPE, "the id names no known version of the chip",
      "is it a copy? owsctl read shows its address; memory and pages can be read")
ERROR(EDOM, "a value out of the chip's range",
      "look at the sensor and its supply; owsctl read shows the number")
ERROR(EREMCHG, "a jump beyond MaxStep, held back until it is confirmed",
      "look for noise if there are many; MaxStep has to allow what is true")
ERROR(ECOMM, "the wire is short",
      "data is held at ground: unplug branches until the wire lives again")
ERROR(ERANGE, "reading of a sensor without power, or out of range",
      "look at its supply line; parasite power may need a strong pull-up")
ERROR(ENODATA, "the device itself reports that it has no value",
      "an open or shorted sensor, or no supply; owsctl dir shows the flags that it has")
ERROR(ETIME, "its turn did not come in time",
      "the bus has more to do than fits: raise Period or PerFactor")
ERROR(ETIMEDOUT, "no answer in time", "owsctl stats shows how the target does; Timeout is the limit")
ERROR(EINPROGRESS, "no answer in time; the device may have done it",
      "owsctl get shows what it does; Timeout is the limit")
ERROR(ENOTCONN, "the target is down", "owsctl stats says why; owsd tries again by itself")
ERROR(ECONNREFUSED, "the target refuses the connection",
      "does an owserver run there, and is its port right?")
ERROR(ECONNRESET, "the target closed the connection", "owsd connects again by itself")
ERROR(EPIPE, "the target closed the connection", "owsd connects again by itself")
ERROR(EPROTO, "the target answered garbage", "is it an owserver that listens there?")
ERROR(EOPNOTSUPP, "this target cannot do that", "owsctl dir shows what the target has")
/* clang-format on */
