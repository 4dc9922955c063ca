/* SPDX-License-Identifier: MIT */
/*
 * An hour of a wire on which one bit in a thousand is turned over, with a chip of each family: what
 * it says is true or an error, and what it says was written is. The inputs, the memories and the
 * outputs change all the time. A thermometer fed by the wire is not among them: it cannot show that
 * it converts (docs/native.md), and misses two conversions in a row once in some thousand.
 */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

#define HOUR (3600 * HOST_S)
#define STATES 4
#define NOISE 0.001

static const char *const chips[] = {
	"DS18B20", "DS18S20", "DS1822",  "DS1825", "DS28EA00", "DS2405", "DS2406", "DS2408",
	"DS2413",  "DS2423",  "DS2430A", "DS2431", "DS2433",   "DS2438", "DS2450", "DS2401",
};
#define CHIPS (sizeof(chips) / sizeof(chips[0]))

static const struct {
	const char *chip, *property;
} reads[] = {
	{"DS18B20", "temperature"},
	{"DS18B20", "power"},
	{"DS18B20", "temphigh"},
	{"DS18S20", "temperature"},
	{"DS1822", "temperature"},
	{"DS1825", "temperature"},
	{"DS28EA00", "temperature"},
	{"DS28EA00", "sensed.BYTE"},
	{"DS2405", "sensed"},
	{"DS2406", "sensed.BYTE"},
	{"DS2406", "pages/page.1"},
	{"DS2406", "set_alarm"},
	{"DS2408", "sensed.BYTE"},
	{"DS2408", "set_alarm"},
	{"DS2413", "sensed.BYTE"},
	{"DS2423", "pages/page.2"},
	{"DS2423", "counter.A"},
	{"DS2430A", "memory"},
	{"DS2430A", "status"},
	{"DS2431", "pages/page.2"},
	{"DS2433", "pages/page.7"},
	{"DS2438", "VAD"},
	{"DS2438", "VDD"},
	{"DS2438", "temperature"},
	{"DS2438", "vis"},
	{"DS2438", "humidity"},
	{"DS2438", "pages/page.4"},
	{"DS2450", "volt.ALL"},
	{"DS2450", "8bit/volt2.ALL"},
	{"DS2401", "present"},
};
#define READS (sizeof(reads) / sizeof(reads[0]))

/* Of other chips, as what an output does is seen at the pins. */
static const struct {
	const char *chip, *property, *text[2];
} writes[] = {
	{"DS2405", "PIO", {"0", "1"}},
	{"DS2406", "PIO.BYTE", {"           1", "           2"}},
	{"DS2408", "PIO.BYTE", {"         165", "          90"}},
	{"DS2413", "PIO.BYTE", {"           2", "           1"}},
	{"DS2450", "PIO.D", {"0", "1"}},
	{"DS28EA00", "latch.BYTE", {"           1", "           2"}},
	{"DS18B20", "templow", {"          -3", "          12"}},
	{"DS2438", "pages/page.5", {"abcdefgh", "ABCDEFGH"}},
	{"DS2431",
         "pages/page.0",
         {"0123456789abcdef0123456789abcdef", "fedcba9876543210fedcba9876543210"}},
};
#define WRITES (sizeof(writes) / sizeof(writes[0]))

static struct trouble trouble;
static struct sim_slave *slave[CHIPS], *output[WRITES];
static char truth[STATES][READS][64];
static uint32_t truth_len[STATES][READS];
static unsigned good, wrong, refused, written, unwritten;

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static struct sim_slave *the(const char *chip)
{
	for (size_t i = 0; i < CHIPS; i++)
		if (strcmp(chips[i], chip) == 0)
			return slave[i];
	return NULL;
}

static void change(unsigned state)
{
	for (size_t i = 0; i < CHIPS; i++) {
		const struct sim_input *inputs = slave[i]->family->inputs;
		bool counts = strcmp(chips[i], "DS2423") == 0;
		size_t size = 0;

		for (unsigned n = 0; !counts && inputs && inputs[n].name; n++) {
			double value = 0.6 + 0.37 * n + 0.71 * state;

			if (inputs[n].pin)
				value = (n + state) % 2;
			else if (strcmp(inputs[n].name, "temperature") == 0)
				value = 5.5 + 13.5 * state + (double)i;
			else if (strcmp(inputs[n].name, "vdd") == 0)
				value = 3 + 0.61 * state;
			wire_set(slave[i], inputs[n].name, value);
		}
		if (!slave[i]->family->memory)
			continue;
		uint8_t *memory = slave[i]->family->memory(slave[i], &size);
		/* Not what a DS2438 measures. */
		size_t first = strcmp(chips[i], "DS2430A") == 0 ? 0 : 32;
		size_t end = strcmp(chips[i], "DS2438") == 0 ? 40 : size == 512 ? 256 : 128;

		for (size_t n = first; n < size && n < end; n++)
			memory[n] = (uint8_t)(n * 7 + 0x31 * state + i);
	}
}

static void noise(bool on)
{
	trouble.kind = on ? TROUBLE_NOISE : TROUBLE_NONE;
	trouble.probability = NOISE;
	trouble.deaf = false;
}

static void report(const char *chip, const char *property, const char *said, const char *is)
{
	char text[200];

	snprintf(text, sizeof(text), "%s %s: '%.40s' for '%.40s'", chip, property, said, is);
	TEST_MESSAGE(text);
}

static void read_all(unsigned state, bool learn)
{
	uint32_t id[READS];

	for (size_t i = 0; i < READS; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(the(reads[i].chip), reads[i].property),
		            NULL);
	for (size_t i = 0; i < READS; i++) {
		const struct bus_answer *answer = answer_to(id[i]);

		if (learn) {
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, reads[i].property);
			truth_len[state][i] = answer->len;
			memcpy(truth[state][i], data[id[i]], answer->len);
		} else if (answer->err) {
			refused++;
		} else if (answer->len == truth_len[state][i] &&
		           memcmp(truth[state][i], data[id[i]], answer->len) == 0) {
			good++;
		} else {
			wrong++;
			report(reads[i].chip, reads[i].property, (char *)data[id[i]],
			       truth[state][i]);
		}
	}
	forget();
}

static void write_one(unsigned n, unsigned turn)
{
	const char *path = of(output[n], writes[n].property);
	const char *text = writes[n].text[turn];

	if (result(BUS_WRITE, path, text)) {
		unwritten++;
	} else {
		written++;
		noise(false);
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, path, NULL);
		TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, path);
		if (memcmp(data[id], text, strlen(text)) != 0) {
			wrong++;
			report(writes[n].chip, writes[n].property, (char *)data[id], text);
		}
		noise(true);
	}
	forget();
}

static void test_an_hour_of_noise_makes_no_false_value_good(void)
{
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	trouble.random = 20252;
	trouble_none(&trouble);
	for (size_t i = 0; i < CHIPS; i++)
		slave[i] = wire_add(0, chips[i], (unsigned)i + 1);
	for (size_t i = 0; i < WRITES; i++)
		output[i] = wire_add(0, writes[i].chip, (unsigned)i + 100);
	change(0);
	start();
	for (unsigned state = 0; state < STATES; state++) {
		change(state);
		read_all(state, true);
	}
	noise(true);
	int64_t end = host.now + HOUR;
	for (unsigned turn = 0; host.now < end; turn++) {
		change(turn % STATES);
		read_all(turn % STATES, false);
		write_one(turn % WRITES, turn / WRITES % 2);
		host_run(&host, bus, host.now + HOST_S);
		forget();
		host.events = 0;
	}
	wire_net.trouble = NULL;
	char text[200];
	snprintf(text, sizeof(text), "%u good, %u errors; %u written, %u not; %u bits turned over",
	         good, refused, written, unwritten, (unsigned)trouble.turned);
	TEST_MESSAGE(text);
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(1000, good);
	TEST_ASSERT_GREATER_THAN_UINT(100, written);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_hour_of_noise_makes_no_false_value_good);
	return UNITY_END();
}
