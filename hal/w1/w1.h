/* SPDX-License-Identifier: MIT */
/*
 * The bus "w1": the native bus over what the kernel's 1-Wire drivers show under
 * /sys/bus/w1/devices. The parts:
 *
 *   bus.c      the target, masters that come later
 *   master.c   the masters as a link master; the lists of slaves; alarms
 *   file.c     one attribute read or written, and what its errors mean
 *   name.c     28.551DDF030000 is 28-000003df1d55
 *   driver.c   which attributes stand for which property
 *   link.c     the commands of a family's functions, answered from attributes
 *   rw.c thermometer.c ds2438.c ds2413.c   ... family by family
 *   switches.c memory.c   properties that are attributes themselves
 *   alarm.c    what the conditional search would find
 *   uevent.c   the kernel tells that slaves and masters come and go
 *
 * The target "w1:netlink" is in netlink.h.
 */
#ifndef HAL_W1_H
#define HAL_W1_H

#include "hal/native/files.h"
#include "hal/native/native.h"

#define W1_ROOT "/sys/bus/w1/devices"
#define W1_ROOT_MAX 160
#define W1_NAME_MAX 16 /* "28-000003df1d55" with NUL */
#define W1_MASTERS NATIVE_CHANNELS
#define W1_TEXT_MAX 4096

struct w1_wire;

/* What is remembered of a slave. */
struct w1_slave {
	uint8_t rom[8];
	uint8_t channel;
	bool due;               /* thermometer: told to convert, not read since */
	bool known;             /* scratchpad holds what was read last */
	bool told_driver;       /* the log was told that no driver has it */
	uint8_t scratchpad[9];  /* thermometer */
	uint8_t config;         /* DS2438: the configuration in force */
	uint8_t mask, polarity; /* DS2408 */
	int64_t condition_ns;   /* when these two were read; 0: not */
	int64_t read_ns;        /* when the scratchpad was; 0: not */
};

struct w1_link {
	struct link link;
	struct w1_master *master;
	unsigned number; /* of w1_bus_masterN */
	int64_t bulk_ns; /* therm_bulk_read was refused: not before */
	bool searched;   /* its first search is over */
	/* Since the last reset: */
	const struct w1_wire *wire;
	struct w1_slave *slave;
	uint8_t command[80];
	size_t length;
	bool all; /* Skip ROM */
};

struct w1_master {
	struct link_master master;
	char root[W1_ROOT_MAX];
	unsigned only; /* w1_bus_masterN; 0: all */
	unsigned count;
	struct w1_link links[W1_MASTERS];
	struct w1_slave slaves[DEVICE_MAX];
	unsigned slave_count;
	bool told_rights;
	int64_t look_ns;                    /* when to look for masters that came later */
	int uevents;                        /* socket; -1: none */
	int64_t uevents_ns;                 /* when to look at it */
	_Alignas(8) char text[W1_TEXT_MAX]; /* an attribute that is being looked at */
	char lists[8 * W1_TEXT_MAX];        /* a list of slaves */
};

extern const struct link_master_ops w1_master;
extern const struct link_files w1_files;
extern const struct link_ops w1_link_ops;

/* Of a function of driver.c's tables. */
static inline struct w1_master *w1_master_of(const struct txn *txn)
{
	return ((struct w1_link *)txn->link)->master;
}

/* name.c: "28-000003df1d55" from a ROM id, and back. False: it is none. */
void w1_name(const uint8_t rom[8], char name[W1_NAME_MAX]);
bool w1_name_parse(const char *name, size_t len, uint8_t rom[8]);

/*
 * file.c: an attribute of a directory in root. Blocks for as long as the kernel takes. Bytes, or
 *   -ENODEV the directory is gone, -ENOENT it has no such attribute, -EACCES it can only be read,
 *   -EPERM no right (told in the log once), -EINVAL the kernel refuses the value, -EIO any other
 *   error
 */
int w1_read(struct w1_master *master, const char *directory, const char *name, void *data,
            size_t room);
int w1_write(struct w1_master *master, const char *directory, const char *name, const void *data,
             size_t n);
bool w1_exists(const struct w1_master *master, const char *directory, const char *name);
/* The same of a slave. */
int w1_slave_read(struct w1_master *master, const uint8_t rom[8], const char *name, void *data,
                  size_t room);
/* The same from a byte of the file on. */
int w1_slave_read_at(struct w1_master *master, const uint8_t rom[8], const char *name, unsigned at,
                     void *data, size_t room);
int w1_slave_write_at(struct w1_master *master, const uint8_t rom[8], const char *name, unsigned at,
                      const void *data, size_t n);
/* Text with NUL, in master->text; -EIO when it is empty: so the kernel tells a failed reading. */
int w1_slave_text(struct w1_master *master, const uint8_t rom[8], const char *name);
int w1_slave_number(struct w1_master *master, const uint8_t rom[8], const char *name, long *number);
int w1_slave_write(struct w1_master *master, const uint8_t rom[8], const char *name,
                   const void *data, size_t n);
bool w1_slave_has(const struct w1_master *master, const uint8_t rom[8], const char *name);
/*
 * The slaves of a master, a line each, sorted, in master->lists; bytes or an error. From its
 * directory: w1_master_slaves takes a mutex that a master being removed holds while it waits for
 * who reads its attributes, and both hang for good.
 */
int w1_slaves(struct w1_master *master, const char *directory);
/* A line for the log. */
void w1_note(struct w1_master *master, int err, const char *text);

/* master.c */
unsigned w1_look_for_masters(struct w1_master *master); /* how many were added */
void w1_master_name(unsigned number, char name[24]);
/* Its place, a new one if need be; NULL: no more. */
struct w1_slave *w1_slave_of(struct w1_master *master, const uint8_t rom[8]);

/* link.c: commands of a family, without Match ROM. */
struct w1_wire {
	/* A whole command was sent. */
	int (*command)(struct w1_link *link);
	/* ... and then n bytes are read. */
	int (*answer)(struct w1_link *link, uint8_t *bytes, size_t n);
	/* ... or one slot; NULL: no command has that. */
	int (*bit)(struct w1_link *link);
};
extern const struct w1_wire w1_rw_wire, w1_thermometer_wire, w1_ds2438_wire, w1_ds2413_wire;

/* driver.c */
struct w1_way {
	const char *property;
	const char *file;     /* there is no such property without it; NULL: the driver's first */
	uint8_t first, count; /* these elements only; count 0: all */
	property_function *read, *write; /* NULL: the family's own, over the wire */
};
struct w1_driver {
	uint8_t family;
	const char *files[2]; /* one of them shows that the driver has the slave */
	const struct w1_wire *wire;
	const struct w1_way *ways;
	unsigned count;
};
#define W1_WAYS(table) .ways = (table), .count = sizeof(table) / sizeof((table)[0])
extern const struct w1_driver w1_thermometers[5], w1_switches[3], w1_memories[4], w1_wired[2];
/* The driver that has the slave; NULL: none. */
const struct w1_driver *w1_driver_of(const struct w1_master *master, const uint8_t rom[8]);
/* link_files.property. */
int w1_property(struct link *link, const struct device *device, const struct property *property,
                int extension, property_function **read, property_function **write);

/* thermometer.c: all nine bytes; convert: of a new conversion, if none was read out since. */
int w1_scratchpad(struct w1_master *master, struct w1_slave *slave, uint8_t scratchpad[9]);
/* Convert all on the master's wire; returns when it is over. */
void w1_convert_all(struct w1_link *link);

/* uevent.c: without it (no such right, another name space) the lists are read now and then. */
void w1_uevents_open(struct w1_master *master);
void w1_uevents_close(struct w1_master *master);
/* Takes what there is, never blocks. True: slaves or masters came or went, or some was missed. */
bool w1_uevents_taken(struct w1_master *master);

/* alarm.c: 1, 0, or an error; -EOPNOTSUPP it cannot be told. */
int w1_in_alarm(struct w1_master *master, struct w1_slave *slave);
/* A thermometer that converts when it is asked that: what is known of it is too old. */
bool w1_alarm_converts(const struct w1_master *master, const struct w1_slave *slave);

#endif
