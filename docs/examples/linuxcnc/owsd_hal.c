/* SPDX-License-Identifier: MIT */
/*
 * Signals of owsd as pins of LinuxCNC's HAL. docs/linuxcnc.md says how to install and load it. It
 * is compiled against LinuxCNC's own hal.h and liblinuxcnchal, which are under the LGPL; this file
 * alone is not.
 *
 *     loadusr -W owsd_hal [-n INSTANCE] [-c NAME] [-p MILLISECONDS] [-w SECONDS] [SIGNAL...]
 *
 * Pins of a signal, of all signals if none is named:
 *     owsd.SIGNAL      out (an output of owsd: in), bit, s32, u32 or float
 *     owsd.SIGNAL.ok   out bit: the value can be trusted; else owsd.SIGNAL keeps the last good one
 *     owsd.SIGNAL.age  out float: seconds since it was measured
 * and owsd.alive, out bit: owsd runs. With -c NAME, "owsd" and the component's name are NAME.
 */
#include <errno.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <hal.h>
#include <ows.h>

#define MILLISECOND 1000000
#define BEAT_MS 1000
#define OTHER_TYPE (-EPROTOTYPE) /* of a signal, since a reload, than its pin has */

union pin {
	hal_bit_t *bit;
	hal_s32_t *s32;
	hal_u32_t *u32;
	hal_float_t *real;
};

/* In HAL's shared memory, as all that pins are linked with */
struct row {
	union pin value;
	hal_bit_t *ok;
	hal_float_t *age;
	int id;
	int told; /* the error that was said */
	char name[HAL_NAME_LEN + 1];
	hal_type_t type;
	bool output;
};

struct options {
	const char *instance, *component, *prefix; /* prefix: of the pins */
	long period_ms, wait_s;
	char **names; /* up to NULL */
};

static volatile sig_atomic_t ending;

static void end(int number)
{
	(void)number;
	ending = 1;
}

static void pause_ms(long ms)
{
	struct timespec t = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * MILLISECOND};

	nanosleep(&t, NULL);
}

static int say(const char *what, int err)
{
	fprintf(stderr, "owsd_hal: %s: %s\n", what, strerror(-err));
	return err;
}

/* --- Pins ------------------------------------------------------------------------------------- */

/* -ENOTSUP: a text */
static int type_of(uint8_t type, hal_type_t *pin)
{
	switch (type) {
	case OWS_BOOL:
		*pin = HAL_BIT;
		return 0;
	case OWS_SHORT:
	case OWS_LONG:
		*pin = HAL_S32;
		return 0;
	case OWS_BYTE:
	case OWS_WORD:
	case OWS_DWORD:
		*pin = HAL_U32;
		return 0;
	case OWS_FLOAT:
	case OWS_DOUBLE:
	case OWS_LARGE:
		*pin = HAL_FLOAT;
		return 0;
	}
	return -ENOTSUP;
}

static void put(struct row *row, const struct ows_value *v)
{
	if (row->type == HAL_BIT)
		*row->value.bit = v->number != 0;
	else if (row->type == HAL_S32)
		*row->value.s32 = (int32_t)v->integer;
	else if (row->type == HAL_U32)
		*row->value.u32 = (uint32_t)v->integer;
	else
		*row->value.real = v->number;
}

static double take(const struct row *row)
{
	if (row->type == HAL_BIT)
		return *row->value.bit ? 1 : 0;
	if (row->type == HAL_S32)
		return *row->value.s32;
	if (row->type == HAL_U32)
		return *row->value.u32;
	return *row->value.real;
}

static bool is_output(struct ows *h, const char *name)
{
	struct ows_info info;

	for (int i = 0; i < ows_count(h); i++) {
		if (ows_info(h, i, &info) == 0 && !strcmp(info.name, name))
			return info.output;
	}
	return false;
}

static int make_pins(struct row *row, const char *prefix, int comp, const char *name)
{
	hal_pin_dir_t dir = row->output ? HAL_IN : HAL_OUT;
	int err = 0;

	if (row->type == HAL_BIT)
		err = hal_pin_bit_newf(dir, &row->value.bit, comp, "%s.%s", prefix, name);
	else if (row->type == HAL_S32)
		err = hal_pin_s32_newf(dir, &row->value.s32, comp, "%s.%s", prefix, name);
	else if (row->type == HAL_U32)
		err = hal_pin_u32_newf(dir, &row->value.u32, comp, "%s.%s", prefix, name);
	else
		err = hal_pin_float_newf(dir, &row->value.real, comp, "%s.%s", prefix, name);
	if (!err)
		err = hal_pin_bit_newf(HAL_OUT, &row->ok, comp, "%s.%s.ok", prefix, name);
	if (!err)
		err = hal_pin_float_newf(HAL_OUT, &row->age, comp, "%s.%s.age", prefix, name);
	return err;
}

/* An output's pin begins with what the signal has, so that loading this changes nothing */
static int add(struct ows *h, struct row *row, const struct options *o, int comp, const char *name)
{
	struct ows_value v;
	int err;

	row->id = ows_find(h, name);
	if (row->id < 0)
		return row->id;
	err = ows_get(h, row->id, ows_now(), &v);
	if (err && err != -ESTALE)
		return err;
	row->output = is_output(h, name);
	if (type_of(v.type, &row->type))
		return -ENOTSUP;
	if (strlen(o->prefix) + strlen(name) + sizeof("..age") - 1 > HAL_NAME_LEN)
		return -ENAMETOOLONG;
	strcpy(row->name, name);
	err = make_pins(row, o->prefix, comp, name);
	if (!err)
		put(row, &v);
	return err;
}

/* How many rows, or negative */
static int add_named(struct ows *h, struct row *rows, const struct options *o, int comp)
{
	int n = 0;

	for (char **name = o->names; *name; name++) {
		int err = add(h, &rows[n++], o, comp, *name);

		if (err)
			return say(*name, err);
	}
	return n;
}

/* The whole table; what HAL cannot have is said and left out */
static int add_table(struct ows *h, struct row *rows, const struct options *o, int comp)
{
	struct ows_info info;
	int n = 0;

	for (int i = 0; i < ows_count(h); i++) {
		int err = ows_info(h, i, &info);

		if (!err)
			err = add(h, &rows[n], o, comp, info.name);
		if (!err)
			n++;
		else if (say(info.name, err) != -ENOTSUP && err != -ENAMETOOLONG)
			return err;
	}
	return n;
}

/* --- The cycle -------------------------------------------------------------------------------- */

static void tell(struct row *row, int err)
{
	if (err == OTHER_TYPE && err != row->told)
		fprintf(stderr, "owsd_hal: %s: has another type than its pin now: load owsd_hal again\n",
		        row->name);
	else if (err && err != row->told)
		say(row->name, err);
	row->told = err;
}

/* Returns true if owsd was restarted or reloaded */
static bool update(struct ows *h, struct row *row, int64_t now)
{
	struct ows_value v;
	bool stale = false, good;
	hal_type_t type;
	int err = 0;

	if (row->output) {
		err = ows_set(h, row->id, take(row), NULL);
		stale = err == -ESTALE;
		tell(row, stale ? 0 : err);
	}
	good = stale || !err;
	err = ows_get(h, row->id, now, &v);
	stale = stale || err == -ESTALE;
	if (err && err != -ESTALE) {
		*row->ok = 0;
		return stale;
	}
	good = good && ows_good(v.quality);
	if (!row->output) {
		err = type_of(v.type, &type) || type != row->type ? OTHER_TYPE : 0;
		tell(row, err);
		good = good && !err;
	}
	/* A reader never finds a bad value with ok */
	if (!good)
		*row->ok = 0;
	else if (!row->output)
		put(row, &v);
	*row->age = (double)v.age_ns / 1e9;
	if (good)
		*row->ok = 1;
	return stale;
}

static void run(struct ows *h, struct row *rows, int n, hal_bit_t **alive,
                const struct options *o)
{
	uint32_t beat_ms = o->period_ms * 3 > BEAT_MS ? (uint32_t)o->period_ms * 3 : BEAT_MS;
	bool outputs = false;

	for (int i = 0; i < n; i++)
		outputs = outputs || rows[i].output;
	while (!ending) {
		int64_t now = ows_now();
		struct ows_daemon daemon;
		bool stale = false;

		for (int i = 0; i < n; i++)
			stale = update(h, &rows[i], now) || stale;
		if (outputs)
			stale = ows_beat(h, beat_ms) == -ESTALE || stale;
		**alive = ows_daemon(h, now, &daemon) == 0 && daemon.alive;
		if (stale)
			ows_reopen(h); /* -ENOENT: it is not back yet */
		pause_ms(o->period_ms);
	}
}

/* --- Start ------------------------------------------------------------------------------------ */

static int open_owsd(const struct options *o, struct ows **h)
{
	int64_t until = ows_now() + o->wait_s * 1000 * MILLISECOND;
	int err;

	while ((err = ows_open(o->instance, OWS_CONTROL, h)) == -ENOENT && ows_now() < until && !ending)
		pause_ms(100);
	/* Without the right to set there are still inputs */
	if (err == -EACCES)
		err = ows_open(o->instance, OWS_READ, h);
	return err ? say("cannot open owsd", err) : 0;
}

static int serve(struct ows *h, int comp, const struct options *o)
{
	struct row *rows;
	hal_bit_t **alive = hal_malloc(sizeof(*alive));
	int room = 0, n, err;

	while (o->names[room])
		room++;
	room = room ? room : ows_count(h);
	rows = hal_malloc(sizeof(*rows) * (size_t)(room ? room : 1));
	if (!alive || !rows)
		return say("HAL's memory", -ENOMEM);
	memset(rows, 0, sizeof(*rows) * (size_t)room);
	err = hal_pin_bit_newf(HAL_OUT, alive, comp, "%s.alive", o->prefix);
	if (err)
		return say("alive", err);
	n = o->names[0] ? add_named(h, rows, o, comp) : add_table(h, rows, o, comp);
	if (n < 0)
		return n;
	err = hal_ready(comp);
	if (err)
		return say("hal_ready", err);
	run(h, rows, n, alive, o);
	return 0;
}

static int usage(void)
{
	fprintf(stderr, "usage: owsd_hal [-n INSTANCE] [-c NAME] [-p MILLISECONDS] [-w SECONDS] "
	                "[SIGNAL...]\n");
	return 2;
}

int main(int argc, char **argv)
{
	struct options o = {.component = "owsd_hal", .prefix = "owsd", .period_ms = 50, .wait_s = 10};
	static struct ows *h; /* to the end of the process, see below */
	int option, comp, err;

	while ((option = getopt(argc, argv, "n:c:p:w:")) != -1) {
		if (option == 'n')
			o.instance = optarg;
		else if (option == 'c')
			o.component = o.prefix = optarg;
		else if (option == 'p')
			o.period_ms = atol(optarg);
		else if (option == 'w')
			o.wait_s = atol(optarg);
		else
			return usage();
	}
	if (o.period_ms < 1 || o.period_ms > 10000 || o.wait_s < 0)
		return usage();
	o.names = argv + optind;
	signal(SIGTERM, end);
	signal(SIGINT, end);
	comp = hal_init(o.component);
	if (comp < 0)
		return say("hal_init", comp), 1;
	err = open_owsd(&o, &h);
	if (!err)
		err = serve(h, comp, &o);
	/* Not closed, so that owsd is not told: outputs go to their SafeValue when the beat stops */
	hal_exit(comp);
	return err ? 1 : 0;
}
