/* SPDX-License-Identifier: MIT */
/*
 * How soon each kind of signal shows on a native bus that its device was pulled off and is back,
 * by engine, bus and simulator in virtual time; alone on the wire, and among 25 of its kind.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/plant.h"

#define MANY 25
#define PHASES 3 /* of a look each two seconds */
#define PHASE_MS 730
#define GONE_NS (10 * PLANT_S)
#define SOON_NS (3 * PLANT_S)
#define ALARM \
	"Alarm on LatchAlarm \"latch.BYTE\" PorAlarm \"por\" SetAlarm \"set_alarm=133333333\" " \
	"ResetLatch \"latch.BYTE=0\" "

static struct plant plant;
static char rio[8192], scenario[4096];

static const struct kind {
	const char *what, *property, *keys;
	bool output;
} kinds[] = {
	{"alarm item", "sensed.BYTE", ALARM, false},
	{"PerFactor 1000", "sensed.BYTE", "PerFactor 1000 ", false},
	{"ReadBack 0", "PIO.BYTE", "ReadBack 0 ", true},
	{"InitValue", "PIO.BYTE", "ReadBack 0 InitValue \"85\" ", true},
	{"ReadBack", "PIO.BYTE", "InitValue \"85\" ", true},
};
#define KINDS (sizeof(kinds) / sizeof(kinds[0]))

void setUp(void)
{
}
void tearDown(void)
{
}

/* One of the chips is pulled off at 20 s and some, for 10 s. */
static void write_files(const struct kind *kind, unsigned chips, unsigned phase)
{
	size_t n = 0, m = 0;

	m += (size_t)snprintf(scenario, sizeof(scenario), "i2c speed 400\nchip DS2482-100 0x18\n");
	n += (size_t)snprintf(rio, sizeof(rio), "OwsDrv {\n");
	for (unsigned i = 0; i < chips; i++) {
		m += (size_t)snprintf(scenario + m, sizeof(scenario) - m,
		                      "DS2408 29.0000000000%02X as c%u\n", i + 1, i);
		n += (size_t)snprintf(rio + n, sizeof(rio) - n,
		                      "\tItem { Name \"s%u\" Path \"/29.0000000000%02X/%s\" "
		                      "Type \"byte\" IO \"%s\" %s}\n",
		                      i, i + 1, kind->property, kind->output ? "output" : "input",
		                      kind->keys);
	}
	snprintf(rio + n, sizeof(rio) - n, "}\n");
	snprintf(scenario + m, sizeof(scenario) - m, "at %ums unplug c%u for %us\n", 20000 + phase,
	         chips / 2, (unsigned)(GONE_NS / PLANT_S));
}

static int64_t until(unsigned record, bool good, int64_t at_most_ns)
{
	int64_t from = plant.now;

	while (ows_good(plant_sample(&plant, record).quality) != good &&
	       plant.now < from + at_most_ns)
		plant_run(&plant, plant.now + 10 * PLANT_MS);
	return plant.now - from;
}

static void goes_and_comes(const struct kind *kind, unsigned chips, unsigned phase)
{
	unsigned record = chips / 2 + 1;
	char message[100];
	int64_t bad_ns, good_ns, begins_ns;

	write_files(kind, chips, phase);
	plant_begin(&plant, scenario, rio);
	begins_ns = plant.start + 20 * PLANT_S + phase * PLANT_MS;
	plant_run(&plant, plant.start + 5 * PLANT_S);
	for (unsigned r = 1; kind->output && r <= chips; r++)
		plant_set(&plant, r, 85);
	plant_run(&plant, begins_ns);
	for (unsigned r = 1; r <= chips; r++)
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, plant_sample(&plant, r).quality,
		                               kind->what);
	bad_ns = until(record, false, GONE_NS);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_NO_DEVICE, plant_sample(&plant, record).quality,
	                               kind->what);
	plant_run(&plant, begins_ns + GONE_NS);
	good_ns = until(record, true, 60 * PLANT_S);
	snprintf(message, sizeof(message), "%s, of %u: bad after %lld ms, good after %lld ms",
	         kind->what, chips, (long long)(bad_ns / PLANT_MS),
	         (long long)(good_ns / PLANT_MS));
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(SOON_NS, bad_ns, message);
	TEST_ASSERT_LESS_THAN_INT64_MESSAGE(SOON_NS, good_ns, message);
	for (unsigned r = 1; r <= chips; r++)
		TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_GOOD, plant_sample(&plant, r).quality,
		                               message);
	plant_end(&plant);
}

static void test_a_device_alone_on_its_wire(void)
{
	for (size_t i = 0; i < KINDS * PHASES; i++)
		goes_and_comes(&kinds[i / PHASES], 1, i % PHASES * PHASE_MS);
}

static void test_one_of_many(void)
{
	for (size_t i = 0; i < KINDS * PHASES; i++)
		goes_and_comes(&kinds[i / PHASES], MANY, i % PHASES * PHASE_MS);
}

/*
 * The adapter is pulled for 4 s, and the boards lose their supply meanwhile. Returns the quality
 * after a minute; until then none is good that was neither read nor written.
 */
static uint8_t adapter_goes_and_comes(const struct kind *kind)
{
	int64_t end_ns;
	uint32_t count;

	write_files(kind, 3, 0);
	strcpy(strstr(scenario, "at "),
	       "at 20s remove adapter for 4s\nat 21s brownout c0\nat 21s brownout c1\n");
	plant_begin(&plant, scenario, rio);
	plant_run(&plant, plant.start + 5 * PLANT_S);
	for (unsigned r = 1; kind->output && r <= 3; r++)
		plant_set(&plant, r, 85);
	plant_run(&plant, plant.start + 22 * PLANT_S);
	TEST_ASSERT_EQUAL_HEX8_MESSAGE(OWS_Q_TARGET, plant_sample(&plant, 1).quality, kind->what);
	count = plant_sample(&plant, 1).count;
	for (end_ns = plant.now + 60 * PLANT_S; plant.now < end_ns;) {
		plant_run(&plant, plant.now + 5 * PLANT_MS);
		if (ows_good(plant_sample(&plant, 1).quality))
			TEST_ASSERT_GREATER_THAN_UINT32_MESSAGE(
				count, plant_sample(&plant, 1).count, kind->what);
		if (plant_sample(&plant, 1).quality != OWS_Q_TARGET)
			TEST_ASSERT_NOT_EQUAL_MESSAGE(-ENOTCONN, plant_sample(&plant, 1).err,
			                              kind->what);
	}
	return plant_sample(&plant, 1).quality;
}

static void test_no_signal_is_good_unread_after_its_adapter_was_pulled(void)
{
	for (size_t i = 0; i < KINDS; i++) {
		uint8_t quality = adapter_goes_and_comes(&kinds[i]);

		TEST_ASSERT_EQUAL_HEX8_MESSAGE(strstr(kinds[i].keys, "ReadBack 0")
		                                       ? OWS_Q_LAST_USABLE
		                               : kinds[i].output ? OWS_Q_DIFFERS
		                                                 : OWS_Q_GOOD,
		                               quality, kinds[i].what);
		plant_end(&plant);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_device_alone_on_its_wire);
	RUN_TEST(test_one_of_many);
	RUN_TEST(test_no_signal_is_good_unread_after_its_adapter_was_pulled);
	return UNITY_END();
}
