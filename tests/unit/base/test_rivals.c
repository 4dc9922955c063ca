/* SPDX-License-Identifier: MIT */
/* Other programs that have the adapter open, in a folder like /proc, and what the log is told. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/rivals.h"
#include "hal/base/time.h"
#include "hal/ds2482/every.h"
#include "hal/ds2482/i2c_master.h"
#include "hal/ds2482/master.h"
#include "hal/native/native.h"
#include "hal/sim/scenario.h"
#include "unity.h"

#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

#define DEVICE "/dev/null" /* of the adapter: a device file that every machine has */

static char proc[64], said[BUS_EVENT_TEXT];
static unsigned disturbs; /* after so many transfers of the driver; 0: never */

static void fill(const char *name, const char *text)
{
	char path[192];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", proc, name);
	file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fprintf(file, "%s\n", text));
	TEST_ASSERT_EQUAL_INT(0, fclose(file));
}

/* A process with a descriptor of that file. */
static void run(int pid, const char *comm, const char *file)
{
	char path[128];

	snprintf(path, sizeof(path), "%s/%d", proc, pid);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
	snprintf(path, sizeof(path), "%s/%d/fd", proc, pid);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
	snprintf(path, sizeof(path), "%s/%d/fd/7", proc, pid);
	TEST_ASSERT_EQUAL_INT(0, symlink(file, path));
	snprintf(path, sizeof(path), "%d/comm", pid);
	fill(path, comm);
}

/* One of another user, of which only the name is to be seen. */
static void hide(int pid, const char *comm)
{
	char path[128];

	snprintf(path, sizeof(path), "%s/%d", proc, pid);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
	snprintf(path, sizeof(path), "%d/comm", pid);
	fill(path, comm);
}

void setUp(void)
{
	ds_begin();
	snprintf(proc, sizeof(proc), "/tmp/owsd-rivals-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(proc));
	disturbs = 0;
}

void tearDown(void)
{
	char command[96];

	ds_end();
	snprintf(command, sizeof(command), "rm -r %s", proc);
	TEST_ASSERT_EQUAL_INT(0, system(command));
}

static unsigned find(void)
{
	return rivals_find(proc, DEVICE, said, RIVALS_TEXT);
}

/* It has ended. */
static void end(int pid)
{
	char command[96];

	snprintf(command, sizeof(command), "rm -r %s/%d", proc, pid);
	TEST_ASSERT_EQUAL_INT(0, system(command));
}

static void test_a_program_that_has_the_adapter_open_is_named(void)
{
	run(80, "bash", "/dev/zero");
	run(81, "cat", "/etc/passwd");
	run(109, "owserver", DEVICE);
	TEST_ASSERT_EQUAL_UINT(1, find());
	TEST_ASSERT_EQUAL_STRING("owserver, process 109", said);
	end(109);
	TEST_ASSERT_EQUAL_UINT(0, find());
	TEST_ASSERT_EQUAL_STRING("", said);
}

static void test_a_program_of_owfs_whose_files_are_hidden_is_a_suspect(void)
{
	run(80, "bash", DEVICE);
	run(109, "owserver", "/dev/zero");
	TEST_ASSERT_EQUAL_INT(0, rivals_hidden(proc, said, RIVALS_TEXT));
	TEST_ASSERT_EQUAL_STRING("", said);
	end(80);
	end(109);
	hide(80, "bash");
	TEST_ASSERT_EQUAL_INT(0, rivals_hidden(proc, said, RIVALS_TEXT));
	hide(109, "owserver");
	TEST_ASSERT_EQUAL_INT(109, rivals_hidden(proc, said, RIVALS_TEXT));
	TEST_ASSERT_EQUAL_STRING("owserver (process 109)", said);
}

static void test_several_programs_are_named_together(void)
{
	run(109, "owserver", DEVICE);
	run(110, "owserver", DEVICE);
	TEST_ASSERT_EQUAL_UINT(2, find());
	TEST_ASSERT_NOT_NULL(strstr(said, "owserver, process 109"));
	TEST_ASSERT_NOT_NULL(strstr(said, "owserver, process 110"));
	TEST_ASSERT_NOT_NULL(strstr(said, " and "));
}

/* The text has no room for all of them. */
static void test_of_many_programs_two_are_named_and_the_others_counted(void)
{
	const char *first, *second;

	for (int i = 0; i < 12; i++)
		run(2147483600 + i, "a-name-as-long!", DEVICE);
	TEST_ASSERT_EQUAL_UINT(12, find());
	first = strstr(said, "a-name-as-long!, process 21474836");
	TEST_ASSERT_EQUAL_PTR(said, first);
	second = strstr(first + 1, " and a-name-as-long!, process 21474836");
	TEST_ASSERT_NOT_NULL_MESSAGE(second, said);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(second, " and 10 more"), said);
}

static void test_programs_that_take_the_lock_and_this_one_are_no_rivals(void)
{
	run(300, "owsd", DEVICE);
	run(301, "owsd-sim", DEVICE);
	run(302, "owsctl", DEVICE);
	run(getpid(), "test", DEVICE);
	TEST_ASSERT_EQUAL_UINT(0, find());
	TEST_ASSERT_EQUAL_STRING("", said);
}

/* As a program of another user is to the service. */
static void test_what_is_hidden_is_nobody(void)
{
	run(109, "owserver", "/nothing");
	TEST_ASSERT_EQUAL_UINT(0, find());
	TEST_ASSERT_EQUAL_UINT(0, rivals_find("/nothing", DEVICE, said, RIVALS_TEXT));
	TEST_ASSERT_EQUAL_UINT(0, rivals_find(proc, "/nothing", said, RIVALS_TEXT));
	TEST_ASSERT_EQUAL_STRING("", said);
}

static void test_a_process_has_a_name_where_it_can_be_seen(void)
{
	run(109, "owserver", DEVICE);
	rivals_name(proc, 109, said, sizeof(said));
	TEST_ASSERT_EQUAL_STRING("owserver (process 109)", said);
	rivals_name(proc, 110, said, sizeof(said));
	TEST_ASSERT_EQUAL_STRING("process 110", said);
	rivals_name(proc, 0, said, sizeof(said));
	TEST_ASSERT_EQUAL_STRING("another target or process", said);
}

/* --- The driver ------------------------------------------------------------------------------- */

static void start(void)
{
	ds_start("chip DS2482-100 0x18\nDS18B20 28.A0B1C2000028 as t temperature 20\n");
	((struct ds2482_master *)ds.master)->source.name = DEVICE;
	((struct ds2482_master *)ds.master)->source.proc = proc;
}

/* What stands, after an error of a link or without. */
static const char *trouble(bool failed)
{
	memset(said, 'x', sizeof(said));
	ds2482_trouble(ds.master, failed, said, sizeof(said));
	return said;
}

static void later(int64_t minutes)
{
	ds.host.now += minutes * 60 * HOST_S;
}

/* Another driver configures the chip. */
static void change(void)
{
	ds_event("reset 0x18");
	TEST_ASSERT_EQUAL_INT(-ENXIO, part_reset(ds.wire));
	TEST_ASSERT_EQUAL_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
}

#define OPEN_IN(who) \
	"/dev/null is also open in " who ": two programs on one DS2482 disturb each other"

static void test_who_has_the_adapter_when_it_is_opened_is_named_until_it_ends(void)
{
	run(109, "owserver", DEVICE);
	start();
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(false));
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(false));
	later(2);
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(false));
	end(109);
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(false)); /* not looked */
	later(2);
	TEST_ASSERT_EQUAL_STRING("", trouble(false));
}

static void test_who_comes_later_is_named_when_it_disturbs(void)
{
	start();
	TEST_ASSERT_EQUAL_STRING("", trouble(false));
	run(109, "owserver", DEVICE);
	TEST_ASSERT_EQUAL_STRING("", trouble(true)); /* at most one look a minute */
	change();
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(true));
	end(109);
	/* a link's error without a change of the chip, too */
	run(110, "python3", DEVICE);
	later(2);
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("python3, process 110"), trouble(true));
}

static void test_what_was_named_and_goes_on_hidden_is_trouble_still(void)
{
	run(109, "owserver", DEVICE);
	start();
	TEST_ASSERT_EQUAL_STRING(OPEN_IN("owserver, process 109"), trouble(false));
	end(109);
	later(2);
	change();
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(trouble(true), "0x18 on " DEVICE), said);
}

static void test_where_nobody_is_seen_the_change_stands_until_ten_quiet_minutes_have_passed(void)
{
	start();
	for (unsigned minute = 0; minute < 60; minute++) {
		change();
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(trouble(true), "0x18 on " DEVICE), said);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "owserver"), said);
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "sudo owsd --board"), said);
		later(1);
	}
	for (unsigned minute = 1; minute < 10; minute++) {
		TEST_ASSERT_NOT_NULL_MESSAGE(strstr(trouble(false), "0x18 on " DEVICE), said);
		later(1);
	}
	TEST_ASSERT_EQUAL_STRING("", trouble(false));
}

/* Two minutes with so many errors each. */
static const char *fail_often(unsigned errors)
{
	for (unsigned i = 0; i < 2 * errors; i++) {
		trouble(true);
		ds.host.now += 60 * HOST_S / errors;
	}
	return trouble(false);
}

static void test_where_nobody_is_seen_errors_are_a_reason_if_they_are_many(void)
{
	start();
	TEST_ASSERT_EQUAL_STRING("", fail_often(6));
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(fail_often(40), "commands on " DEVICE " fail again and "
	                                                    "again"),
	                             said);
	later(11);
	trouble(false); /* of the errors after the last look */
	later(11);
	TEST_ASSERT_EQUAL_STRING("", trouble(false));
}

/* What is unplugged was not changed by anybody. */
static void test_a_chip_that_does_not_come_back_was_not_changed(void)
{
	start();
	ds_event("refuse 0x18 for 60s");
	TEST_ASSERT_LESS_THAN_INT(0, part_reset(ds.wire));
	TEST_ASSERT_LESS_THAN_INT(0, ds.wire->ops->recover(ds.wire, LINK_CHIP_RESET));
	TEST_ASSERT_EQUAL_STRING("", trouble(true));
}

static void test_a_simulated_adapter_has_no_rivals(void)
{
	run(109, "owserver", DEVICE);
	start();
	((struct ds2482_master *)ds.master)->source.proc = NULL;
	change();
	TEST_ASSERT_EQUAL_STRING("", trouble(true));
}

/* --- The bus of i2c:auto ---------------------------------------------------------------------- */

/* As an owserver: it resets the wire whenever it wants to, and leaves the chip as it was. */
static const struct i2c_adapter_ops *undisturbed;
static unsigned transfers;

static int disturbed_transfer(struct i2c_adapter *base, uint8_t address,
                              struct i2c_message *messages, size_t n)
{
	uint8_t command = DS2482_RESET;
	struct i2c_message reset = i2c_to_write(&command, 1);

	if (disturbs && ++transfers % disturbs == 0)
		(void)undisturbed->transfer(base, address, &reset, 1);
	return undisturbed->transfer(base, address, messages, n);
}

static int open_disturbed(void *ctx, const struct bus_env *env, struct i2c_adapter **out,
                          char *text, size_t size)
{
	static struct i2c_adapter_ops ops;
	int err = ds_open_adapter(ctx, env, out, text, size);

	if (err)
		return err;
	undisturbed = (*out)->ops;
	ops = *undisturbed;
	ops.transfer = disturbed_transfer;
	(*out)->ops = &ops;
	return 0;
}

static unsigned list(void *ctx, unsigned *numbers, unsigned max)
{
	(void)ctx, (void)max;
	numbers[0] = 1;
	return 1;
}

static int make(void *ctx, unsigned number, const struct bus_env *env, struct link_master **master)
{
	static struct link_master_ops ops;
	const struct ds2482_source source = {
		.open = open_disturbed, .destroy = ds_forget, .name = DEVICE, .proc = proc};

	(void)ctx, (void)number;
	ops = ds_ops;
	ops.trouble = ds2482_trouble;
	return ds2482_create(&ops, env, &source, "", master, ds.why, sizeof(ds.why));
}

static int create_every(const char *where, const struct bus_env *env, struct link_master **master,
                        char *why, size_t why_size)
{
	static const struct every_source source = {.list = list, .make = make};

	(void)where, (void)why, (void)why_size;
	return every_create(env, &source, master);
}

static unsigned notes(const char *text)
{
	unsigned n = 0;

	for (unsigned i = 0; i < ds.host.events; i++)
		n += ds.host.event[i].news == BUS_TROUBLE && strstr(ds.host.event[i].text, text);
	return n;
}

static struct bus *open_bus(void)
{
	static const struct link_master_ops master = {.create = create_every};
	static const struct bus_ops ops = {NATIVE_BUS_SLOTS};
	struct bus *bus;

	TEST_ASSERT_EQUAL_INT(0, sim_scenario_parse("test",
	                                            "chip DS2482-100 0x18\n"
	                                            "DS2401 01.010203040506\n",
	                                            &ds.net, ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_INT(
		0, native_create(&ops, &master, "", &ds.host.env, &bus, ds.why, sizeof(ds.why)));
	host_run(&ds.host, bus, ds.host.now + 5 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, host_events(&ds.host, BUS_TROUBLE));
	return bus;
}

static void test_a_bus_reports_the_program_and_the_change(void)
{
	struct bus *bus = open_bus();

	ds_event("reset 0x18");
	host_run(&ds.host, bus, ds.host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, notes("was reset or changed by another program"));
	run(109, "owserver", DEVICE);
	host_run(&ds.host, bus, ds.host.now + 60 * HOST_S);
	ds_event("reset 0x18");
	host_run(&ds.host, bus, ds.host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, notes("is also open in owserver, process 109"));
	TEST_ASSERT_EQUAL_UINT(2, host_events(&ds.host, BUS_TROUBLE));
	/* the wire is quiet: nothing but the look itself finds that the program has ended */
	end(109);
	host_run(&ds.host, bus, ds.host.now + 130 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(3, host_events(&ds.host, BUS_TROUBLE));
	TEST_ASSERT_EQUAL_STRING("", ds.host.event[ds.host.events - 1].text);
	native_destroy(bus);
}

static void disturb(struct bus *bus, unsigned each)
{
	disturbs = each;
	host_run(&ds.host, bus, ds.host.now + 180 * HOST_S);
}

/* To the service the programs of others are hidden. */
static void test_a_hidden_program_that_works_the_wire_between_is_asked_for_once(void)
{
	struct bus *bus = open_bus();

	disturb(bus, 20);
	TEST_ASSERT_EQUAL_UINT(1, notes("fail again and again: does another program use it"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&ds.host, BUS_TROUBLE));
	native_destroy(bus);
}

static void test_a_program_that_works_the_wire_between_is_named(void)
{
	struct bus *bus = open_bus();

	run(109, "owserver", DEVICE);
	disturb(bus, 20);
	TEST_ASSERT_EQUAL_UINT(1, notes("is also open in owserver, process 109"));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&ds.host, BUS_TROUBLE));
	native_destroy(bus);
}

static void test_a_device_that_cannot_be_opened_is_named_with_what_to_do(void)
{
	static const struct rivals_device device = {"the stick", DEVICE, "plug it in", "dialout"};
	static const struct {
		int err, is;
		const char *why;
	} cases[] = {
		{-ENOENT, -ENODEV, "no the stick: plug it in"},
		{-ENXIO, -ENODEV, "no the stick: plug it in"},
		{-ENODEV, -ENODEV, "no the stick: plug it in"},
		{-EACCES, -EACCES,
	         "no permission for the stick: the user has to be in the group that owns it "
	         "(dialout)"},
		{-EPERM, -EACCES,
	         "the stick: a device filter refuses it (DeviceAllow= of the service, devices of "
	         "the container): restart owsd, or allow it there"},
		{-EADDRINUSE, -EBUSY, "the stick is in use by another target or process"},
		{-EBUSY, -EBUSY, "the stick is in use by "},
		{-EIO, -EIO, "the stick: Input/output error"},
	};
	char why[200];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_EQUAL_INT(cases[i].is,
		                      rivals_refused(cases[i].err, &device, 0, why, sizeof(why)));
		TEST_ASSERT_EQUAL_STRING_LEN(cases[i].why, why, strlen(cases[i].why));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_program_that_has_the_adapter_open_is_named);
	RUN_TEST(test_a_program_of_owfs_whose_files_are_hidden_is_a_suspect);
	RUN_TEST(test_several_programs_are_named_together);
	RUN_TEST(test_of_many_programs_two_are_named_and_the_others_counted);
	RUN_TEST(test_programs_that_take_the_lock_and_this_one_are_no_rivals);
	RUN_TEST(test_what_is_hidden_is_nobody);
	RUN_TEST(test_a_process_has_a_name_where_it_can_be_seen);
	RUN_TEST(test_who_has_the_adapter_when_it_is_opened_is_named_until_it_ends);
	RUN_TEST(test_who_comes_later_is_named_when_it_disturbs);
	RUN_TEST(test_what_was_named_and_goes_on_hidden_is_trouble_still);
	RUN_TEST(test_where_nobody_is_seen_the_change_stands_until_ten_quiet_minutes_have_passed);
	RUN_TEST(test_where_nobody_is_seen_errors_are_a_reason_if_they_are_many);
	RUN_TEST(test_a_chip_that_does_not_come_back_was_not_changed);
	RUN_TEST(test_a_simulated_adapter_has_no_rivals);
	RUN_TEST(test_a_bus_reports_the_program_and_the_change);
	RUN_TEST(test_a_hidden_program_that_works_the_wire_between_is_asked_for_once);
	RUN_TEST(test_a_program_that_works_the_wire_between_is_named);
	RUN_TEST(test_a_device_that_cannot_be_opened_is_named_with_what_to_do);
	return UNITY_END();
}
