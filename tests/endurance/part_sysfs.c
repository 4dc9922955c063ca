/* SPDX-License-Identifier: MIT */
/*
 * What the kernel's 1-Wire drivers show: a tree of files that exist, whose contents are answered
 * here when they are read. A conversion keeps the reader, as it does in the kernel; files vanish,
 * fail, hang and tell nonsense.
 */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/owfs/path.h"
#include "hal/w1/name.h"
#include "tests/endurance/part.h"

#define DESCRIPTORS 256
#define CONVERT_NS (750 * FIELD_MS)
#define TIMEOUT_NS (20 * FIELD_S)
#define CALLS 64

int __real_open(const char *path, int flags, ...);
int __real_open64(const char *path, int flags, ...);
ssize_t __real_read(int fd, void *data, size_t n);
ssize_t __real___read_chk(int fd, void *data, size_t n, size_t room);
ssize_t __real_write(int fd, const void *data, size_t n);
int __real_close(int fd);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open64(const char *path, int flags, ...);
ssize_t __wrap_read(int fd, void *data, size_t n);
ssize_t __wrap___read_chk(int fd, void *data, size_t n, size_t room);
ssize_t __wrap_write(int fd, const void *data, size_t n);
int __wrap_close(int fd);

enum trouble { NONE, FAILS, HANGS, NO_CRC, NO_TEXT, EMPTY_FILE, POWER_ON, TROUBLES };
static const char *const troubles[TROUBLES] = {
	[FAILS] = "files fail",           [HANGS] = "the kernel hangs",
	[NO_CRC] = "checksums are wrong", [NO_TEXT] = "files tell nonsense",
	[EMPTY_FILE] = "files are empty", [POWER_ON] = "85 of the power-on",
};

struct sysfs {
	char root[40];
	struct part *part;
	enum trouble trouble;
	unsigned chance;
	int64_t hangs_ns; /* until then */
	/* the last calls that took long */
	struct {
		int64_t begin, end;
	} longest[CALLS];
	unsigned calls;
	bool no_master;
	/* the switch */
	uint8_t output, activity, mask, polarity, control;
	/* what a descriptor was opened for; device -1: none of ours */
	struct {
		int device;
		char name[32];
		bool read;
	} open[DESCRIPTORS];
};

static struct sysfs *tree; /* one at a time */

/* --- The files ------------------------------------------------------------------------------- */

static void path_of(const struct sysfs *s, unsigned device, bool inner, char path[120])
{
	char name[W1_NAME_MAX];
	uint8_t rom[8];

	if (rom_parse(field.device[device].id, strlen(field.device[device].id), rom))
		abort();
	w1_name(rom, name);
	snprintf(path, 120, "%s/%s%s", s->root, inner ? "w1_bus_master1/" : "", name);
}

static void put_file(const char *directory, const char *name)
{
	char path[200];
	int fd;

	snprintf(path, sizeof(path), "%s/%s", directory, name);
	fd = __real_open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0644);
	if (fd < 0)
		abort();
	__real_close(fd);
}

static const char *const thermometer_files[] = {"name",       "w1_slave",  "alarms",
                                                "resolution", "ext_power", NULL};
static const char *const switch_files[] = {"name",
                                           "output",
                                           "state",
                                           "activity",
                                           "status_control",
                                           "cond_search_mask",
                                           "cond_search_polarity",
                                           NULL};

static const char *const *files_of(unsigned device)
{
	return field.device[device].is_switch ? switch_files : thermometer_files;
}

static void attach(struct sysfs *s, unsigned device)
{
	char inner[120], outer[120];

	path_of(s, device, true, inner);
	path_of(s, device, false, outer);
	if (mkdir(inner, 0755))
		return;
	for (const char *const *file = files_of(device); *file; file++)
		put_file(inner, *file);
	if (symlink(inner, outer))
		abort();
}

static void detach(struct sysfs *s, unsigned device)
{
	char inner[120], outer[120], path[200];

	path_of(s, device, true, inner);
	path_of(s, device, false, outer);
	unlink(outer);
	for (const char *const *file = files_of(device); *file; file++) {
		snprintf(path, sizeof(path), "%s/%s", inner, *file);
		unlink(path);
	}
	rmdir(inner);
}

static bool here(const struct part *part, unsigned device)
{
	return !field.device[device].away && field.device[device].wire == part->wire;
}

static void make_master(struct sysfs *s)
{
	char path[120];

	snprintf(path, sizeof(path), "%s/w1_bus_master1", s->root);
	mkdir(path, 0755);
	put_file(path, "uevent");
	for (unsigned i = 0; i < field.devices; i++)
		if (here(s->part, i))
			attach(s, i);
}

static void remove_master(struct sysfs *s)
{
	char path[120];

	for (unsigned i = 0; i < field.devices; i++)
		detach(s, i);
	snprintf(path, sizeof(path), "%s/w1_bus_master1/uevent", s->root);
	unlink(path);
	snprintf(path, sizeof(path), "%s/w1_bus_master1", s->root);
	rmdir(path);
}

static void power_on(struct sysfs *s)
{
	s->output = 0xff;
	s->activity = 0;
	s->mask = s->polarity = 0;
	s->control = 0x88; /* has restarted, fed from outside */
}

static void begin(struct part *part, char *target, unsigned size)
{
	struct sysfs *s = calloc(1, sizeof(*s));

	if (!s || tree)
		abort();
	part->own = tree = s;
	s->part = part;
	for (unsigned i = 0; i < DESCRIPTORS; i++)
		s->open[i].device = -1;
	strcpy(s->root, "/tmp/owsd-endurance-XXXXXX");
	if (!mkdtemp(s->root))
		abort();
	power_on(s);
	make_master(s);
	snprintf(target, size, "w1:root=%s/w1_bus_master1", s->root);
}

static void end(struct part *part)
{
	struct sysfs *s = part->own;

	remove_master(s);
	rmdir(s->root);
	tree = NULL;
	free(s);
}

/* --- Their contents -------------------------------------------------------------------------- */

static enum trouble trouble_now(const struct sysfs *s)
{
	return world_random(100) < s->chance ? s->trouble : NONE;
}

static void block(struct sysfs *s, int64_t ns)
{
	int64_t begin = world_now();

	world_block(ns);
	if (world_now() - begin <= CONVERT_NS)
		return;
	/* after a suspend an answer is as old as its request, which has waited for others */
	if (world_now() > begin + ns)
		begin -= TIMEOUT_NS;
	s->longest[s->calls % CALLS].begin = begin;
	s->longest[s->calls++ % CALLS].end = world_now();
}

/* A reading looks at several files, up to three times, and one of them converts. */
static int64_t given(const struct part *part, int64_t measured_ns)
{
	const struct sysfs *s = part->own;
	int64_t ns = measured_ns;

	for (unsigned i = 0; i < CALLS; i++) {
		int64_t begin = s->longest[i].begin, end = s->longest[i].end + CONVERT_NS;

		if (begin <= ns + 5 * FIELD_S && end >= measured_ns && end > ns) {
			ns = end;
			i = UINT_MAX; /* one may have followed that was looked at before */
		}
	}
	return ns;
}

static size_t scratchpad(const struct sysfs *s, unsigned device, enum trouble trouble, char *text,
                         size_t size)
{
	double degrees = field_temperature(device, world_now());
	int raw = (int)(degrees * 16 + (degrees < 0 ? -0.5 : 0.5));
	uint8_t pad[9];
	size_t n = 0;

	(void)s;
	if (trouble == POWER_ON)
		raw = 0x550;
	pad[0] = (uint8_t)raw;
	pad[1] = (uint8_t)(raw >> 8);
	pad[2] = 75;
	pad[3] = 70;
	pad[4] = 0x7f;
	pad[5] = 0xff;
	pad[6] = trouble == POWER_ON ? 0x0c : (uint8_t)(16 - (raw & 15));
	pad[7] = 0x10;
	pad[8] = rom_crc8(pad, 8);
	if (trouble == NO_CRC)
		pad[8] ^= 0x5a;
	for (int i = 0; i < 9; i++)
		n += (size_t)snprintf(text + n, size - n, "%02x ", pad[i]);
	n += (size_t)snprintf(text + n, size - n, ": crc=%02x %s\nt=%d\n", pad[8],
	                      trouble == NO_CRC ? "NO" : "YES", raw * 1000 / 16);
	return n;
}

static int switch_byte(const struct sysfs *s, const char *name)
{
	if (strcmp(name, "output") == 0)
		return s->output;
	if (strcmp(name, "state") == 0)
		return (int)(field_pins() << 4) | (s->output & 0xf);
	if (strcmp(name, "activity") == 0)
		return s->activity;
	if (strcmp(name, "cond_search_mask") == 0)
		return s->mask;
	if (strcmp(name, "cond_search_polarity") == 0)
		return s->polarity;
	if (strcmp(name, "status_control") == 0)
		return s->control;
	return -1;
}

/* Bytes, or -1 with errno. */
static ssize_t contents(struct sysfs *s, unsigned device, const char *name, char *text, size_t size)
{
	enum trouble trouble = trouble_now(s);
	int value;

	if (trouble == HANGS && world_now() < s->hangs_ns)
		block(s, s->hangs_ns - world_now());
	if (strcmp(name, "w1_slave") == 0)
		block(s, CONVERT_NS);
	if (!here(s->part, device) || s->no_master) {
		errno = ENODEV;
		return -1;
	}
	if (trouble == FAILS) {
		errno = EIO;
		return -1;
	}
	if (trouble == EMPTY_FILE)
		return 0;
	if (trouble == NO_TEXT && !field.device[device].is_switch)
		return snprintf(text, size, "xyz\n");
	if (strcmp(name, "w1_slave") == 0)
		return (ssize_t)scratchpad(s, device, trouble, text, size);
	if (strcmp(name, "alarms") == 0)
		return snprintf(text, size, "70 75\n");
	if (strcmp(name, "resolution") == 0)
		return snprintf(text, size, "12\n");
	if (strcmp(name, "ext_power") == 0)
		return snprintf(text, size, "1\n");
	value = switch_byte(s, name);
	if (value < 0) {
		errno = EIO;
		return -1;
	}
	text[0] = (char)value;
	return 1;
}

static ssize_t put(struct sysfs *s, unsigned device, const char *name, const uint8_t *data,
                   size_t n)
{
	enum trouble trouble = trouble_now(s);

	if (trouble == HANGS && world_now() < s->hangs_ns)
		block(s, s->hangs_ns - world_now());
	if (!here(s->part, device) || s->no_master) {
		errno = ENODEV;
		return -1;
	}
	if (trouble == FAILS || n < 1) {
		errno = EIO;
		return -1;
	}
	if (strcmp(name, "output") == 0)
		s->output = data[0];
	else if (strcmp(name, "activity") == 0)
		s->activity = 0;
	else if (strcmp(name, "cond_search_mask") == 0)
		s->mask = data[0];
	else if (strcmp(name, "cond_search_polarity") == 0)
		s->polarity = data[0];
	else if (strcmp(name, "status_control") == 0)
		s->control = (uint8_t)((data[0] & 7) | (data[0] & s->control & 8) | 0x80);
	return (ssize_t)n;
}

/* --- In the place of the system calls -------------------------------------------------------- */

static int note_open(const char *path, int fd)
{
	const char *slash;
	int device = -1;

	if (!tree || fd < 0 || fd >= DESCRIPTORS ||
	    strncmp(path, tree->root, strlen(tree->root)) != 0)
		return fd;
	slash = strrchr(path, '/');
	for (unsigned i = 0; i < field.devices && device < 0; i++) {
		char outer[120];

		path_of(tree, i, false, outer);
		if (strncmp(path, outer, strlen(outer)) == 0 && slash == path + strlen(outer))
			device = (int)i;
	}
	tree->open[fd].device = device;
	tree->open[fd].read = false;
	snprintf(tree->open[fd].name, sizeof(tree->open[fd].name), "%s", slash + 1);
	return fd;
}

static bool is_ours(int fd)
{
	return tree && fd >= 0 && fd < DESCRIPTORS && tree->open[fd].device >= 0;
}

static mode_t mode_of(int flags, va_list more)
{
	return flags & O_CREAT ? va_arg(more, mode_t) : 0;
}

int __wrap_open(const char *path, int flags, ...)
{
	va_list more;
	mode_t mode;

	va_start(more, flags);
	mode = mode_of(flags, more);
	va_end(more);
	return note_open(path, __real_open(path, flags, mode));
}

int __wrap_open64(const char *path, int flags, ...)
{
	va_list more;
	mode_t mode;

	va_start(more, flags);
	mode = mode_of(flags, more);
	va_end(more);
	return note_open(path, __real_open64(path, flags, mode));
}

static ssize_t read_ours(int fd, void *data, size_t n)
{
	char text[256];
	ssize_t len;

	if (tree->open[fd].read)
		return 0;
	tree->open[fd].read = true;
	len = contents(tree, (unsigned)tree->open[fd].device, tree->open[fd].name, text,
	               sizeof(text));
	if (len > 0 && (size_t)len > n)
		len = (ssize_t)n;
	if (len > 0)
		memcpy(data, text, (size_t)len);
	return len;
}

ssize_t __wrap_read(int fd, void *data, size_t n)
{
	return is_ours(fd) ? read_ours(fd, data, n) : __real_read(fd, data, n);
}

ssize_t __wrap___read_chk(int fd, void *data, size_t n, size_t room)
{
	return is_ours(fd) ? read_ours(fd, data, n) : __real___read_chk(fd, data, n, room);
}

ssize_t __wrap_write(int fd, const void *data, size_t n)
{
	if (!is_ours(fd))
		return __real_write(fd, data, n);
	return put(tree, (unsigned)tree->open[fd].device, tree->open[fd].name, data, n);
}

int __wrap_close(int fd)
{
	if (is_ours(fd))
		tree->open[fd].device = -1;
	return __real_close(fd);
}

/* --- What goes wrong ------------------------------------------------------------------------- */

static void untrouble(void *ctx)
{
	struct sysfs *s = ctx;

	s->trouble = NONE;
	s->chance = 0;
}

static void return_master(void *ctx)
{
	struct sysfs *s = ctx;

	if (!s->no_master)
		return;
	s->no_master = false;
	make_master(s);
}

static const char *fault(struct part *part, int64_t ns)
{
	struct sysfs *s = part->own;

	if (world_random(8) == 0 && !s->no_master) {
		s->no_master = true;
		remove_master(s);
		world_after(ns, return_master, s);
		return "the master goes";
	}
	s->trouble = 1 + world_random(TROUBLES - 1);
	s->chance = world_random(2) ? 100 : 1 + world_random(60);
	s->hangs_ns = world_now() + ns;
	world_after(ns, untrouble, s);
	return troubles[s->trouble];
}

static void restart(struct part *part, unsigned device)
{
	if (field.device[device].is_switch)
		power_on(part->own);
}

static void plug(struct part *part, unsigned device, bool in)
{
	struct sysfs *s = part->own;

	if (in)
		restart(part, device);
	if (!in)
		detach(s, device);
	else if (!s->no_master)
		attach(s, device);
}

static void pins(struct part *part)
{
	struct sysfs *s = part->own;

	s->activity |= 0xf0;
}

static unsigned relays(struct part *part)
{
	const struct sysfs *s = part->own;

	return ~(unsigned)s->output & 0xf;
}

const struct part_ops part_sysfs = {
	.name = "sysfs",
	.age_ns = 2 * FIELD_S,
	.given = given,
	.begin = begin,
	.end = end,
	.fault = fault,
	.plug = plug,
	.restart = restart,
	.pins = pins,
	.relays = relays,
};
