/* SPDX-License-Identifier: MIT */
/*
 * owsctl doctor on recorded machines, each a file of tests/unit/data/machines: "first", what its
 * first line has to be, with ROOT for the folder; then files, "@ PATH" and their text, and links,
 * "@ PATH -> TARGET". And what it makes of signals; and the table of faces.
 */
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/board/report.h"
#include "src/memory/shm/entries.h"
#include "src/tool/owsctl/machine/command.h"
#include "src/tool/owsctl/machine/doctor.h"
#include "src/tool/owsctl/machine/faces.h"
#include "src/tool/owsctl/verbs.h"
#include "tests/unit/aid/caught.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

#define MACHINES "tests/unit/data/machines/*.machine"

static char root[32];

void setUp(void)
{
	setenv("OWSD_BOARDS", "board/boards", 1);
	strcpy(root, "/tmp/doctor-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(root));
	TEST_ASSERT_EQUAL(0, chmod(root, 0755));
	caught_begin("OWS");
}

void tearDown(void)
{
	char command[64];

	caught_end();
	snprintf(command, sizeof(command), "rm -rf '%s'", root);
	TEST_ASSERT_EQUAL(0, system(command));
}

static FILE *make_file(const char *name)
{
	char path[560];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", root, name);
	for (char *slash = path + strlen(root) + 1; (slash = strchr(slash, '/')); slash++) {
		*slash = '\0';
		mkdir(path, 0755);
		*slash = '/';
	}
	file = fopen(path, "we");
	TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
	return file;
}

/* "PATH -> TARGET" */
static FILE *make_link(char *name)
{
	char *target = strstr(name, " -> "), path[560];

	*target = '\0';
	fclose(make_file(name));
	snprintf(path, sizeof(path), "%s/%s", root, name);
	TEST_ASSERT_EQUAL(0, unlink(path));
	TEST_ASSERT_EQUAL(0, symlink(target + strlen(" -> "), path));
	return NULL;
}

static void write_file(const char *name, const char *text)
{
	FILE *file = make_file(name);

	fputs(text, file);
	fclose(file);
}

/* The text with the folder in place of each ROOT. */
static void put_root(const char *text, char *to, size_t size)
{
	const char *at;
	size_t used = 0;

	for (; (at = strstr(text, "ROOT")); text = at + strlen("ROOT"))
		used += (size_t)snprintf(to + used, size - used, "%.*s%s", (int)(at - text), text,
		                         root);
	snprintf(to + used, size - used, "%s", text);
}

/* Make its files; its expected first line goes to first. */
static void unpack(const char *machine, char *first, size_t size)
{
	char line[512];
	FILE *in = fopen(machine, "re"), *out_file = NULL;

	TEST_ASSERT_NOT_NULL_MESSAGE(in, machine);
	*first = '\0';
	while (fgets(line, sizeof(line), in)) {
		bool names = !strncmp(line, "@ ", 2);

		if (names || !strncmp(line, "first ", 6))
			line[strcspn(line, "\n")] = '\0';
		if (names && out_file)
			fclose(out_file);
		if (names)
			out_file = strstr(line, " -> ") ? make_link(line + 2) : make_file(line + 2);
		else if (out_file)
			fputs(line, out_file);
		else
			put_root(line + strlen("first "), first, size);
	}
	if (out_file)
		fclose(out_file);
	fclose(in);
}

static void doctor_at_root(const char *more)
{
	char words[80];

	snprintf(words, sizeof(words), "doctor --root %s%s", root, more);
	unsetenv("OWS_DIR");
	run(verb_doctor, words);
	setenv("OWS_DIR", folder_dir()->path, 1);
}

static void test_the_first_line_is_the_remedy_of_each_recorded_machine(void)
{
	char first[600];
	glob_t found;

	TEST_ASSERT_EQUAL(0, glob(MACHINES, 0, NULL, &found));
	TEST_ASSERT_GREATER_THAN(15, found.gl_pathc);
	for (size_t i = 0; i < found.gl_pathc; i++) {
		unpack(found.gl_pathv[i], first, sizeof(first));
		doctor_at_root("");
		out[strcspn(out, "\n")] = '\0';
		TEST_ASSERT_EQUAL_STRING_MESSAGE(first, out, found.gl_pathv[i]);
		tearDown();
		setUp();
	}
	globfree(&found);
}

static void test_json_has_the_same_with_what_is_safe(void)
{
	char first[600];

	unpack("tests/unit/data/machines/no-module.machine", first, sizeof(first));
	fclose(make_file("dev/serial/by-id/usb-FTDI_LinkUSB-if00-port0"));
	doctor_at_root(" --json");
	holds(out, "[{\"kind\":\"todo\",\"check\":\"board\",\"text\":\"there is no /dev/i2c-1");
	holds(out, "\"safe\":true}");
	holds(out, "serial port: /dev/serial/by-id/usb-FTDI_LinkUSB-if00-port0\"");
	holds(out,
	      "{\"kind\":\"fact\",\"check\":\"board\",\"text\":\"board: Raspberry Pi 4 Model B");
}

static void test_an_adapter_of_the_kernel_is_left_there_and_both_ways_are_named(void)
{
	char first[600];

	unpack("tests/unit/data/machines/no-file-usb-kernel.machine", first, sizeof(first));
	doctor_at_root("");
	holds(out, "note: the kernel's driver DS9490R has the USB adapter: target w1\n"
	           "    with usb: in place of w1 owsd takes it");
}

static void test_a_wrong_file_is_reported_once_and_not_by_each_service(void)
{
	char first[600];

	unpack("tests/unit/data/machines/wrong-file.machine", first, sizeof(first));
	doctor_at_root("");
	holds(out, "OWS.rio:3:");
	TEST_ASSERT_NULL_MESSAGE(strstr(out, "fails"), out);
	TEST_ASSERT_NULL_MESSAGE(strstr(out, "\n2. "), out);
}

/* A program writes its name and status into /run itself, and anybody names the file of an owsd. */
static void test_a_command_to_paste_has_the_words_that_it_names_and_no_others(void)
{
	struct board_report found = {0};
	char name[sizeof(found.line->remedy) / 4];

	report_add(&found, BOARD_MISSING, "x");
	report_command(&found, "cp new.rio %s; kill %d    # 100 of %s", "/home/o'a/$(id) 1.rio", -7,
	               "OWS");
	TEST_ASSERT_EQUAL_STRING("cp new.rio '/home/o'\\''a/$(id) 1.rio'; kill -7    # 100 of OWS",
	                         found.line->remedy);
	memset(name, '\'', sizeof(name) - 1);
	name[sizeof(name) - 1] = '\0';
	report_command(&found, "rm %s", name);
	TEST_ASSERT_EQUAL_STRING("", found.line->remedy);
}

static void test_only_commands_that_change_no_plant_are_safe(void)
{
	static const char *const yes[] = {
		"sudo modprobe i2c-dev    # at each start: echo i2c-dev | sudo tee /etc/x.conf",
		"sudo systemd-sysusers    # then: sudo systemctl restart 'owsd@*'",
		"sudo systemd-tmpfiles --create",
		"sudo systemctl start owsd-mqtt@OWS.service",
		"sudo systemctl restart owsd-web@my_house.2",
	};
	static const char *const no[] = {
		"",
		"sudo systemctl start owsd@OWS.service",
		"sudo systemctl enable --now owsd-mqtt@OWS.service",
		"sudo systemctl start owsd-mqtt@OWS.service; reboot",
		"sudo systemctl start owsd-$(reboot)@OWS.service",
		/* what a program may have written into its report */
		"sudo systemd-tmpfiles --create /tmp/mine.conf",
		"sudo systemd-sysusers /tmp/mine.conf",
		"sudo modprobe i2c-dev -C /tmp/mine",
		"sudo systemctl start owsd-mqtt@OWS.service reboot.target",
		"sudo systemctl restart owsd-web@OWS ssh",
		"sudo systemctl restart owsd-[a-z]@OWS",
		"sudo systemctl restart owsd-",
		"sudo timedatectl set-ntp true", /* somebody has switched it off */
		"owsd-mqtt says: sudo systemctl restart owsd-web@OWS",
		"sudo reboot",
		"echo dtoverlay=w1-gpio | sudo tee -a /boot/firmware/config.txt && sudo reboot",
	};

	for (size_t i = 0; i < sizeof(yes) / sizeof(yes[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(doctor_is_safe(yes[i]), yes[i]);
	for (size_t i = 0; i < sizeof(no) / sizeof(no[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(doctor_is_safe(no[i]), no[i]);
}

/* Of a program that was taken over, what it reports and what it logs. */
static void test_words_of_a_program_are_never_a_command_of_this_one(void)
{
	static const char report[] = "pid 1\nbeat 1\nstatus lost\ntrouble sudo systemd-sysusers\n";
	char first[600];

	unpack("tests/unit/data/machines/broker-away.machine", first, sizeof(first));
	write_file("run/owsd/OWS.owsd-mqtt", report);
	doctor_at_root(" --json");
	holds(out, "\"remedy\":\"owsd-mqtt says: sudo systemd-sysusers\",\"safe\":false");
	unpack("tests/unit/data/machines/port-in-use.machine", first, sizeof(first));
	write_file("recorded/journal-owsd@OWS.service", "sudo systemd-sysusers\n");
	doctor_at_root(" --json");
	holds(out, "\"remedy\":\"owsd@OWS.service says: sudo systemd-sysusers\",\"safe\":false");
}

static void test_the_clock_is_set_by_who_may_and_is_left_to_who_decides(void)
{
	static const char *const cases[][2] = {
		{"CanNTP=no\nNTP=no\n", "    sudo apt install systemd-timesyncd\n"},
		{"CanNTP=yes\nNTP=no\n", "    sudo timedatectl set-ntp true\n"},
		{"CanNTP=yes\nNTP=yes\n", "    timedatectl timesync-status\n"}};
	char first[600], text[64];

	unpack("tests/unit/data/machines/nothing-wrong.machine", first, sizeof(first));
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		snprintf(text, sizeof(text), "Timezone=UTC\n%sNTPSynchronized=no\n", cases[i][0]);
		write_file("recorded/timedatectl", text);
		doctor_at_root("");
		holds(out, "note: nobody sets the clock");
		holds(out, cases[i][1]);
	}
}

static void test_a_command_is_run_without_a_shell(void)
{
	static const char *const says[] = {"echo", "$HOME", NULL}, *const fails[] = {"false", NULL},
				 *const absent[] = {"/nowhere/program", NULL},
				 *const hangs[] = {"sleep", "600", NULL},
				 *const closes[] = {"sh", "-c", "exec sleep 600 >&-", NULL};
	char text[64], small[4];

	TEST_ASSERT_TRUE(command_output(says, INT64_MAX, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("$HOME\n", text);
	TEST_ASSERT_FALSE(command_output(fails, INT64_MAX, text, sizeof(text)));
	TEST_ASSERT_FALSE(command_output(absent, INT64_MAX, text, sizeof(text)));
	TEST_ASSERT_FALSE(command_output(hangs, ows_now() + 200 * NS_PER_MS, text, sizeof(text)));
	TEST_ASSERT_FALSE(command_output(closes, ows_now() + 200 * NS_PER_MS, text, sizeof(text)));
	command_output(says, INT64_MAX, small, sizeof(small));
	TEST_ASSERT_LESS_THAN_size_t(sizeof(small), strlen(small));
	TEST_ASSERT_EQUAL(0, command_line("true beyond", 4));
	TEST_ASSERT_NOT_EQUAL(0, command_line("", 0));
}

static void put_bad(struct instance *in, uint32_t record, uint8_t quality, int error)
{
	struct ows_sample sample = {
		.quality = quality, .err = error, .tried_ns = ows_now(), .target = 1, .count = 1};
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE};

	image_publish(&in->image, record, &sample, &attrs, NULL);
}

static void test_signals_with_the_same_fault_are_one_finding_and_a_short_is_the_first(void)
{
	static const struct instance_signal signals[] = {
		{"attic", "/28.1/temperature", OWS_DOUBLE, false, 0},
		{"cellar", "/28.2/temperature", OWS_DOUBLE, false, 0},
		{"hall", "/28.3/temperature", OWS_DOUBLE, false, 0},
		{"room", "/28.4/temperature", OWS_DOUBLE, false, 0},
		{"yard", "/28.5/temperature", OWS_DOUBLE, false, 0},
		{"unset", "/29.1/PIO.0", OWS_BOOL, true, 0},
	};
	struct instance in;

	instance_start(&in, "doctor", signals, 6);
	for (uint32_t i = 1; i <= 4; i++)
		put_bad(&in, i, OWS_Q_NO_DEVICE, -ENODEV);
	put_bad(&in, 5, OWS_Q_SHORT, -ECOMM);
	put_bad(&in, 6, OWS_Q_INITIAL, 0);
	caught_begin(in.name);
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_doctor, "doctor"));
	holds(out, ". data is held at ground: unplug branches until the wire lives again\n"
	           "   yard: wire short: the wire is short\n");
	holds(out, "   attic, cellar, hall and 1 more: device absent: no such device there\n");
	TEST_ASSERT_TRUE(strstr(out, "yard") < strstr(out, "attic"));
	TEST_ASSERT_NULL_MESSAGE(strstr(out, "unset"), out);
	instance_end(&in);
}

/* The instance has the targets localhost:4304 and w1. */
static void doctor_of(struct instance *in)
{
	char words[80];

	snprintf(words, sizeof(words), "doctor --root %s", root);
	caught_begin(in->name);
	run(verb_doctor, words);
}

static void test_an_owserver_that_is_stopped_is_started_and_one_that_listens_is_not(void)
{
	static const struct instance_signal signals[] = {
		{"attic", "/28.1/temperature", OWS_DOUBLE, false, 0}};
	static const char listens[] =
		"  sl  local_address\n   0: 0100007F:10D0 00000000:0000 0A 0\n";
	struct instance in;

	instance_start(&in, "doctor", signals, 1);
	image_note(&in.image, 0, ows_now(), "127.0.0.1:4304: Connection refused");
	doctor_of(&in);
	holds(out, "owsd says: 127.0.0.1:4304: Connection refused\n   target localhost:4304 is");
	write_file("lib/systemd/system/owserver.service", "");
	doctor_of(&in);
	holds(out, ". sudo systemctl start owserver\n   target localhost:4304 is down");
	write_file("proc/net/tcp", listens);
	doctor_of(&in);
	holds(out, "owsd says: 127.0.0.1:4304: Connection refused\n");
	instance_end(&in);
}

static void test_a_device_that_is_absent_may_have_been_exchanged(void)
{
	static const struct instance_signal signals[] = {
		{"attic", "/28.1/temperature", OWS_DOUBLE, false, 0}};
	char file[120], wanted[300];
	struct instance in;

	instance_start(&in, "doctor", signals, 1);
	put_bad(&in, 1, OWS_Q_NO_DEVICE, -ENODEV);
	snprintf(file, sizeof(file), "etc/owsd/%s.rio", in.name);
	write_file(
		file,
		"OwsDrv { Item { Name \"attic\" Path \"/28.551DDF030000/temperature\" Type double } }");
	doctor_of(&in);
	snprintf(wanted, sizeof(wanted),
	         "was the chip exchanged? sudo owsctl -n %s scan --rio --merge %s/%s >/dev/null",
	         in.name, root, file);
	holds(out, wanted);
	instance_end(&in);
}

/* What only owsd finds, as a target that is none. */
static void test_a_refused_file_is_corrected_before_it_is_loaded_again(void)
{
	static const struct instance_signal signals[] = {
		{"attic", "/28.1/temperature", OWS_DOUBLE, false, 0}};
	char file[120], reason[300], wanted[400];
	struct instance in;

	instance_start(&in, "doctor", signals, 1);
	snprintf(file, sizeof(file), "etc/owsd/%s.rio", in.name);
	write_file(file, "OwsDrv { TargetName \"link\" Item { Name \"a\" "
	                 "Path \"/28.551DDF030000/temperature\" Type double } }");
	snprintf(reason, sizeof(reason), "%s/%s:1:10: error: link is a serial adapter", root, file);
	image_refused(&in.image, ows_now() + 5 * NS_PER_S, false, reason, strlen(reason));
	doctor_of(&in);
	snprintf(wanted, sizeof(wanted),
	         ". correct line 1 of %s/%s, then: sudo owsctl -n %s reload\n", root, file,
	         in.name);
	holds(out, wanted);
	image_refused(&in.image, ows_now() - 60 * NS_PER_S, false, reason, strlen(reason));
	doctor_of(&in);
	TEST_ASSERT_NULL_MESSAGE(strstr(out, "correct line"), out);
	snprintf(wanted, sizeof(wanted), ". sudo owsctl -n %s reload\n", in.name);
	holds(out, wanted);
	instance_end(&in);
}

static void test_words_that_cannot_be_are_refused(void)
{
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_doctor, "doctor now"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_doctor, "doctor --fix --root /"));
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_doctor, "doctor --root /nowhere"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_enable, "enable"));
	TEST_ASSERT_EQUAL(CTL_USAGE, run(verb_enable, "enable teapot"));
	holds(err, "there is no teapot; there are:");
	holds(err, " mqtt");
	caught_ctl.instance = "a/b";
	TEST_ASSERT_EQUAL(CTL_FAILED, run(verb_disable, "disable web"));
	holds(err, "a/b cannot be the name of an instance");
}

static void test_the_table_of_faces_says_what_starts_each(void)
{
	struct face_row rows[FACE_ROWS];
	int count = faces_table(rows);
	const struct face_row *web = faces_find(rows, count, "web"),
			      *history = faces_find(rows, count, "history");
	char unit[FACE_UNIT];

	TEST_ASSERT_NOT_NULL(web);
	TEST_ASSERT_NOT_NULL(history);
	TEST_ASSERT_TRUE(web->socket);
	TEST_ASSERT_FALSE(history->socket);
	TEST_ASSERT_EQUAL_STRING("owsd-recorder", history->package);
	TEST_ASSERT_EQUAL_PTR(web, faces_find(rows, count, "owsd-web"));
	TEST_ASSERT_EQUAL_STRING("owsd-web@OWS.socket", face_unit(web, "OWS", "socket", unit));
}

static void test_a_face_has_what_its_block_asks_for(void)
{
	static const char text[] = "OwsDrv { Web { Listen \"127.0.0.1:8080\" Write on }\n"
				   "Mqtt { Broker \"mqtt://h\" Rename on } }";
	struct config_report report = {0};
	struct config *config;
	char addresses[200];

	TEST_ASSERT_EQUAL(0, config_parse("x", text, strlen(text), &report, &config));
	TEST_ASSERT_TRUE(face_has_block(config, "owsd-mqtt"));
	TEST_ASSERT_FALSE(face_has_block(config, "owsd-influx"));
	TEST_ASSERT_FALSE(face_has_block(config, "owsd-writer"));
	TEST_ASSERT_TRUE(face_may("owsd-influx", NULL));
	TEST_ASSERT_FALSE(face_may("owsd-writer", NULL));
	TEST_ASSERT_TRUE(face_has(config, "owsd-web", "Write"));
	TEST_ASSERT_FALSE(face_has(config, "owsd-web", "Configure"));
	TEST_ASSERT_FALSE(face_has(config, "owsd-mqtt", "Write"));
	TEST_ASSERT_TRUE(face_has(config, "owsd-mqtt", "Rename"));
	TEST_ASSERT_FALSE(face_has(config, "owsd-recorder", "Write"));
	face_addresses(config, addresses, sizeof(addresses));
	TEST_ASSERT_EQUAL_STRING("http://127.0.0.1:8080/", addresses);
	config_free(config);
}

int main(void)
{
	folder_dir();
	UNITY_BEGIN();
	RUN_TEST(test_the_first_line_is_the_remedy_of_each_recorded_machine);
	RUN_TEST(test_json_has_the_same_with_what_is_safe);
	RUN_TEST(test_an_adapter_of_the_kernel_is_left_there_and_both_ways_are_named);
	RUN_TEST(test_a_wrong_file_is_reported_once_and_not_by_each_service);
	RUN_TEST(test_a_command_to_paste_has_the_words_that_it_names_and_no_others);
	RUN_TEST(test_only_commands_that_change_no_plant_are_safe);
	RUN_TEST(test_words_of_a_program_are_never_a_command_of_this_one);
	RUN_TEST(test_the_clock_is_set_by_who_may_and_is_left_to_who_decides);
	RUN_TEST(test_a_command_is_run_without_a_shell);
	RUN_TEST(test_signals_with_the_same_fault_are_one_finding_and_a_short_is_the_first);
	RUN_TEST(test_an_owserver_that_is_stopped_is_started_and_one_that_listens_is_not);
	RUN_TEST(test_a_device_that_is_absent_may_have_been_exchanged);
	RUN_TEST(test_a_refused_file_is_corrected_before_it_is_loaded_again);
	RUN_TEST(test_words_that_cannot_be_are_refused);
	RUN_TEST(test_the_table_of_faces_says_what_starts_each);
	RUN_TEST(test_a_face_has_what_its_block_asks_for);
	return UNITY_END();
}
