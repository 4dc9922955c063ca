/* SPDX-License-Identifier: MIT */
/* What hangs, or cannot be done, in the kernel's files: who else notices? */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "hal/chips/area.h"
#include "hal/chips/field.h"
#include "hal/chips/find.h"
#include "hal/chips/switches/ds2408.h"
#include "unity.h"

#include "hal/bus/worker.h"
#include "hal/chips/family.h"
#include "hal/wire/crc.h"
#include "hal/wire/driver.h"

#define S INT64_C(1000000000)
#define HANGS 0
#define LIVES 1

static char root[64];
static struct worker *worker[2];
static struct bus_req req[2];
static uint8_t data[2][32];
static struct bus_answer answer[2];
static unsigned answers[2];

static int64_t boottime(void)
{
	struct timespec t;

	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * S + t.tv_nsec;
}

static void no_bell(void *ctx)
{
	(void)ctx;
}

static void in_root(char path[200], const char *name)
{
	snprintf(path, 200, "%s/%s", root, name);
}

static void directory(const char *name)
{
	char path[200];

	in_root(path, name);
	TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
}

static void text(const char *name, const char *what)
{
	char path[200];

	in_root(path, name);
	FILE *file = fopen(path, "w");
	TEST_ASSERT_NOT_NULL(file);
	fputs(what, file);
	fclose(file);
}

void setUp(void)
{
	memset(answers, 0, sizeof(answers));
	snprintf(root, sizeof(root), "/tmp/owsd-w1-XXXXXX");
	TEST_ASSERT_NOT_NULL(mkdtemp(root));
}

void tearDown(void)
{
	char line[100];

	snprintf(line, sizeof(line), "rm -rf %s", root);
	TEST_ASSERT_EQUAL_INT(0, system(line));
}

static void start(unsigned n, const char *target)
{
	char why[200] = "";
	int err = worker_create(target, "bus-under-test", no_bell, NULL, &worker[n], why,
	                        sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	TEST_ASSERT_EQUAL_INT(0, worker_start(worker[n]));
}

static void ask(unsigned n, const char *path)
{
	req[n] = (struct bus_req){.op = BUS_READ,
	                          .prio = BUS_INPUT,
	                          .fresh = true,
	                          .path = path,
	                          .data = data[n],
	                          .len = sizeof(data[n]),
	                          .deadline_ns = boottime() + 60 * S};
	TEST_ASSERT_EQUAL_INT(0, worker_submit(worker[n], &req[n]));
}

static void take(unsigned n)
{
	const struct worker_message *message;

	while ((message = worker_next(worker[n]))) {
		if (message->is_event)
			continue;
		answer[n] = message->answer;
		answers[n]++;
	}
}

static void take_until(unsigned n, unsigned count)
{
	for (int64_t until = boottime() + 60 * S; answers[n] < count && boottime() < until;) {
		take(n);
		nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL); /* pace */
	}
	TEST_ASSERT_EQUAL_UINT(count, answers[n]);
}

/* Opening a FIFO for reading lasts until somebody writes: so the worker is held in the kernel. */
static void test_a_read_that_never_returns_stalls_its_own_bus_only(void)
{
	char target[100], fifo[200];

	directory("w1_bus_master1");
	directory("w1_bus_master1/28-0000000000a1");
	directory("28-0000000000a1");
	text("28-0000000000a1/ext_power", "1\n");
	in_root(fifo, "28-0000000000a1/w1_slave");
	TEST_ASSERT_EQUAL_INT(0, mkfifo(fifo, 0644));
	snprintf(target, sizeof(target), "w1:root=%s", root);
	start(HANGS, target);
	start(LIVES, "null:");
	ask(HANGS, "/28.A10000000000/temperature");
	/* It reads: only now there is somebody at the other end. */
	int writer = -1;
	for (int64_t until = boottime() + 60 * S; writer < 0 && boottime() < until;)
		writer = open(fifo, O_WRONLY | O_NONBLOCK);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, writer);
	for (unsigned i = 1; i <= 20; i++) {
		ask(LIVES, "/28.000000000001/temperature");
		take_until(LIVES, i);
	}
	take(HANGS);
	TEST_ASSERT_EQUAL_UINT(0, answers[HANGS]);
	TEST_ASSERT_EQUAL_INT(-ETIMEDOUT, worker_stop(worker[HANGS], S / 10));
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker[LIVES], 20 * S));
	close(writer);
	TEST_ASSERT_EQUAL_INT(0, worker_stop(worker[HANGS], 20 * S));
	worker_destroy(worker[HANGS]);
	worker_destroy(worker[LIVES]);
}

/* --- A link without strong pull-up whose answers are right --- */

static uint8_t sent[16];
static size_t sent_n;

static void write_bytes(const uint8_t *bytes, size_t n)
{
	sent_n = n - 9;
	memcpy(sent, bytes + 9, sent_n);
}

/* A DS2450 that keeps what is written, in pages of eight bytes with a checksum each. */
static uint8_t kept[32];

static void read_bytes(uint8_t *bytes, size_t n)
{
	uint16_t crc = onewire_crc16(0, sent, sent_n);
	size_t at = sent[1];

	if (sent[0] == 0x55)
		kept[at] = sent[sent_n - 1];
	for (size_t i = 0; i < n; crc = 0) {
		size_t part = sent[0] == 0xaa ? 8 : 0;

		memcpy(bytes + i, kept + at, part);
		crc = onewire_crc16(crc, bytes + i, part);
		at += part;
		i += part;
		bytes[i++] = (uint8_t)~crc;
		bytes[i++] = (uint8_t)(~crc >> 8);
		if (i < n && !part)
			bytes[i++] = kept[at];
	}
}

static int run(struct link *link, const struct link_part *part)
{
	(void)link;
	if (part->out_n)
		write_bytes(part->out, part->out_n);
	if (part->in_n)
		read_bytes(part->in, part->in_n);
	return 0;
}

static int slot(struct link *link, bool out, enum link_after after)
{
	(void)link;
	(void)out;
	return after == LINK_STRONG ? -EOPNOTSUPP : 1;
}

static bool has_no_driver(struct link *link, const uint8_t rom[8])
{
	(void)link, (void)rom;
	return false;
}

static int64_t now(void *ctx)
{
	return *(int64_t *)ctx;
}

static void test_a_pull_up_that_a_driver_has_not_is_no_error_of_the_master(void)
{
	static const struct link_ops ops = {.run = run, .slot = slot};
	static const struct link_facts facts = {.strong = true, .splits = true};
	static const struct driver_ops driver = {.has = has_no_driver};
	int64_t time = S;
	struct bus_env env = {.ctx = &time, .now = now};
	struct link link = {.ops = &ops, .facts = &facts, .env = &env, .driver = &driver};
	static unsigned char own[DEVICE_OWN];
	struct device device = {.rom = {0x20, 1}, .family = family_of(0x20), .own = own};
	struct txn txn = {.link = &link, .device = &device};
	int err = TXN_MORE;

	for (unsigned i = 0; !txn.property && i < device.family->count; i++)
		if (strcmp(device.family->properties[i].name, "volt") == 0)
			txn.property = &device.family->properties[i];
	TEST_ASSERT_NOT_NULL(txn.property);
	for (int i = 0; i < 30 && err == TXN_MORE; i++, time += S)
		err = property_reader(device.family, txn.property)(&txn);
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, err);
	TEST_ASSERT_EQUAL_INT(0, txn.link_error);
}

/* --- A driver that stays in the kernel between two of its files --- */

static int64_t *clock_of_hang;

static bool has_driver(struct link *link, const uint8_t rom[8])
{
	(void)link, (void)rom;
	return true;
}

static int read_and_hang(struct link *link, const uint8_t rom[8], const struct area *area,
                         unsigned at, uint8_t *bytes, unsigned n)
{
	(void)link, (void)rom, (void)area;
	memset(bytes, at ? 0x80 : 0xff, n);
	*clock_of_hang += at ? 100 * S : 0;
	return 0;
}

static void test_what_a_driver_gives_is_as_old_as_the_begin_of_its_call(void)
{
	static const struct driver_ops driver = {.has = has_driver, .area_read = read_and_hang};
	int64_t time = S;
	struct bus_env env = {.ctx = &time, .now = now};
	struct link link = {.env = &env, .driver = &driver};
	static _Alignas(8) unsigned char own[DEVICE_OWN];
	struct device device = {.rom = {0x29, 1}, .family = family_of(0x29), .own = own};
	struct txn first = {
		.link = &link, .device = &device, .since_ns = INT64_MAX, .oldest_ns = INT64_MAX};
	struct txn next = first;
	uint8_t pins = 0;

	clock_of_hang = &time;
	TEST_ASSERT_EQUAL_INT(0, area_read(&first, &ds2408_registers, 0, &pins, 1));
	TEST_ASSERT_EQUAL_HEX8(0xff, pins);
	TEST_ASSERT_EQUAL_INT64(101 * S, time);
	TEST_ASSERT_EQUAL_INT64(S, txn_measured(&first));
	next.oldest_ns = 100 * S;
	TEST_ASSERT_FALSE(txn_shared(&next, &ds2408_registers, 0, &pins, 1));
	next.oldest_ns = S;
	TEST_ASSERT_TRUE(txn_shared(&next, &ds2408_registers, 0, &pins, 1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_read_that_never_returns_stalls_its_own_bus_only);
	RUN_TEST(test_a_pull_up_that_a_driver_has_not_is_no_error_of_the_master);
	RUN_TEST(test_what_a_driver_gives_is_as_old_as_the_begin_of_its_call);
	return UNITY_END();
}
