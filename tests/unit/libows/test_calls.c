/* SPDX-License-Identifier: MIT */
/* Which system calls reads and sets make: a child does them under a filter that kills at others. */
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "unity.h"

#include "src/memory/libows/handle.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"valve", "/3A.1/PIO.A", OWS_DOUBLE, true, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
};

static struct instance in;
static struct ows *h;
static int room, valve, label, age;

void setUp(void)
{
	instance_start(&in, "calls", signals, 3);
	instance_put_double(&in, 1, 21.5, ows_now());
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_CONTROL, &h));
	room = ows_find(h, "room");
	valve = ows_find(h, "valve");
	label = ows_find(h, "label");
	age = ows_find(h, "room_Age");
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

/* From here the process dies at any call but its end and, if `rings`, a write. */
static void allow_few(bool rings)
{
	struct sock_filter few[] = {
		BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 2, 0),
		BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, rings ? SYS_write : SYS_exit_group, 1, 0),
		BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL),
		BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
	};
	struct sock_fprog program = {.len = sizeof(few) / sizeof(few[0]), .filter = few};

	if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || prctl(PR_SET_SECCOMP, 2, &program))
		_exit(77);
}

static void read_all(int64_t now_ns)
{
	struct ows_command command;
	struct ows_alarm_state state;
	struct ows_origin origin;
	struct ows_value value;
	char text[80];

	for (int i = 0; i < 1000; i++) {
		ows_get(h, room, now_ns + i, &value);
		ows_get(h, age, now_ns + i, &value);
		ows_get_text(h, label, now_ns + i, &value, text, sizeof(text));
		ows_get_signal(h, 1, now_ns + i, &value);
		ows_command(h, valve, &command);
		ows_alarm_state(h, room, &state);
		ows_origin(h, valve, &origin);
	}
}

static void expect(bool rings, void (*act)(int64_t now_ns))
{
	int64_t now_ns = ows_now();
	pid_t child = fork();
	int status;

	if (child == 0) {
		*h->mine = 1; /* this child stands for the program itself */
		allow_few(rings);
		act(now_ns);
		syscall(SYS_exit_group, 0);
	}
	TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
	if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
		TEST_IGNORE_MESSAGE("no seccomp here");
	TEST_ASSERT_EQUAL_MESSAGE(0, status, "it made a system call");
}

static void set_all(int64_t now_ns)
{
	const double value = 1;

	(void)now_ns;
	for (int i = 0; i < 1000; i++) {
		ows_set(h, valve, i, NULL);
		ows_set_many(h, &valve, &value, 1);
		ows_set_text(h, label, "x", NULL);
		ows_beat(h, 1000);
	}
}

static void set_once(int64_t now_ns)
{
	(void)now_ns;
	ows_set(h, valve, 1, NULL);
}

static void test_a_read_makes_no_system_call(void)
{
	expect(false, read_all);
	image_state(&in.image, OWS_STATE_RETIRED);
	expect(false, read_all);
}

static void test_a_read_makes_none_when_owsds_heart_stands_still(void)
{
	instance_beat(&in, ows_now() - 3600 * INSTANCE_S, 0);
	expect(false, read_all);
	expect(false, set_all);
}

static void test_a_set_makes_none_while_the_engine_is_awake(void)
{
	image_awake(&in.image, true);
	expect(false, set_all);
	TEST_ASSERT_EQUAL(2999, instance_command(&in, 0, 2).stamp);
	TEST_ASSERT_EQUAL(3000, instance_command(&in, 0, 3).stamp);
}

static void test_a_set_makes_one_while_the_engine_sleeps(void)
{
	expect(true, set_once);
	TEST_ASSERT_EQUAL(1, door_rings(in.door, 0));
	expect(true, set_all);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_read_makes_no_system_call);
	RUN_TEST(test_a_read_makes_none_when_owsds_heart_stands_still);
	RUN_TEST(test_a_set_makes_none_while_the_engine_is_awake);
	RUN_TEST(test_a_set_makes_one_while_the_engine_sleeps);
	return UNITY_END();
}
