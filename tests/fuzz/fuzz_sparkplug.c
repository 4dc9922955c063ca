/* SPDX-License-Identifier: MIT */
/*
 * What comes to an edge node of Sparkplug from a broker: payloads of NCMD and DCMD, and the state
 * of the primary host. The first byte of an input chooses the topic, the others are the message.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/mqtt/profiles.h"
#include "src/ground/signal/value.h"
#include "tests/fuzz/heap_instance.h"

#define GROUP "spBv1.0/plant"
#define CHIP "29.551DDF030000"
#define MESSAGE_METRICS 100

static struct stream s;
static int device; /* of the message; -1: the node */
static unsigned taken;

size_t fuzz_memory(size_t n)
{
	/* two bytes may be a metric */
	return 2000000 + 200 * n;
}

static bool put(void *ctx, const char *topic, const char *text, size_t len, bool retain)
{
	(void)ctx;
	(void)text;
	TEST_ASSERT_TRUE(strlen(topic) && len && !retain);
	return true;
}

static void take(void *ctx, const char *name, const char *text, const char *fault)
{
	int64_t value;
	int i = 0, err;

	(void)ctx;
	TEST_ASSERT_TRUE_MESSAGE(++taken <= MESSAGE_METRICS, "too many commands of a message");
	TEST_ASSERT_TRUE(strlen(name) + strlen(text) <= 65536);
	if (fault) {
		TEST_ASSERT_TRUE(*fault);
		return;
	}
	while (i < HEAP_SIGNALS && strcmp(heap_signals[i].name, name) != 0)
		i++;
	TEST_ASSERT_TRUE_MESSAGE(i < HEAP_SIGNALS, name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(device, s.rows[i].chip, "a command of another device");
	if (heap_signals[i].type == OWS_STRING)
		return;
	TEST_ASSERT_TRUE_MESSAGE(strlen(text) < VALUE_TEXT_MAX, text);
	err = value_parse((enum ows_type)heap_signals[i].type, text, &value);
	TEST_ASSERT_TRUE_MESSAGE(!err || err == -ERANGE || err == -EINVAL, text);
}

/* The relay and the level are of a device, the others of the node. */
static void make(struct ows *h)
{
	s = (struct stream){.profile = &profile_sparkplug,
	                    .outlet.put = put,
	                    .prefix = GROUP,
	                    .topic = "plant",
	                    .node = "pi",
	                    .discovery = "ha",
	                    .host = "scada",
	                    .host_ms = 1000};
	TEST_ASSERT_EQUAL_INT(0, stream_open(&s));
	TEST_ASSERT_EQUAL_INT(0, stream_make(&s, h));
	TEST_ASSERT_EQUAL_INT(HEAP_SIGNALS, s.count);
	while (s.chip_count)
		free(s.chips[--s.chip_count].topic);
	s.chips[0] = (struct chip){.id = CHIP, .family = ""};
	s.chip_count = 1;
	s.rows[1].chip = s.rows[4].chip = 0;
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	static const struct {
		const char *topic;
		int device;
	} places[] = {{GROUP "/NCMD/pi", -1},
	              {GROUP "/DCMD/pi/" CHIP, 0},
	              {GROUP "/DCMD/pi/28.FFFFFFFFFFFF", 1},
	              {"spBv1.0/STATE/scada", 0}};
	size_t place = n ? bytes[0] % (sizeof(places) / sizeof(places[0])) : 0, len = n ? n - 1 : 0;
	char *text = malloc(len + 1);
	struct ows *h;

	TEST_ASSERT_NOT_NULL(text);
	if (len)
		memcpy(text, bytes + 1, len);
	text[len] = '\0'; /* as libmosquitto has it */
	heap_instance_reset();
	TEST_ASSERT_EQUAL_INT(0, ows_open("fuzz", OWS_READ, &h));
	make(h);
	device = places[place].device;
	taken = 0;
	if (stream_below(places[place].topic, s.prefix))
		s.profile->take(&s, places[place].topic, text, len, take, NULL);
	else
		TEST_ASSERT_FALSE(s.profile->heard(&s, places[place].topic, text, len));
	TEST_ASSERT_TRUE_MESSAGE(s.host_ms >= 1000, "an old word of the host counts");
	stream_close(&s);
	ows_close(h);
	free(text);
}
