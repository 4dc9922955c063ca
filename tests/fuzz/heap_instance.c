/* SPDX-License-Identifier: MIT */
/* An instance of owsd on the heap, and the way of libows to it. */
#include <stdlib.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "tests/fuzz/heap_instance.h"

const struct heap_signal heap_signals[HEAP_SIGNALS] = {
	{"room", "/28.551DDF030000/temperature", OWS_DOUBLE},
	{"relay", "/29.551DDF030000/PIO.0", OWS_BOOL},
	{"count", "/1D.551DDF030000/counters.A", OWS_LARGE},
	{"label", "/23.551DDF030000/memory", OWS_STRING},
	{"level", "/29.551DDF030000/PIO.BYTE", OWS_BYTE},
	{"warm", "/28.551DDF030000/temperature9", OWS_FLOAT},
};
static const bool is_output[HEAP_SIGNALS] = {false, true, false, true, true, false};
struct heap_instance heap;
static char *image_then, *controller_then;

static char *zeroed(size_t size)
{
	char *memory = aligned_alloc(64, (size + 63) / 64 * 64);

	TEST_ASSERT_NOT_NULL(memory);
	return memset(memory, 0, size);
}

void heap_beat(int64_t now_ns)
{
	struct ows_sample sample = {.measured_ns = now_ns, .quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {.transactions = 7};

	image_publish(&heap.image, 0, &sample, &attrs, NULL);
	image_news(&heap.image);
}

void heap_put(uint32_t record, int64_t value, const char *text, int64_t measured_ns,
              uint32_t applied)
{
	bool is_text = heap_signals[record - 1].type == OWS_STRING;
	struct ows_sample sample = {.value = value,
	                            .measured_ns = measured_ns,
	                            .tried_ns = measured_ns,
	                            .quality = OWS_Q_GOOD,
	                            .count = 1,
	                            .confirmed = applied,
	                            .len = is_text ? (uint32_t)strlen(text) : 0};
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE | OWS_ATTR_WRITE_ENABLE,
	                          .shelved = record == 1};

	image_publish(&heap.image, record, &sample, &attrs, is_text ? text : NULL);
	image_news(&heap.image);
}

static void make(void)
{
	static const char *const targets[] = {"localhost:4304", "w1"};
	static const struct image_counter counters[] = {{"alarms", 0xffffffffu}, {"keepalives", 0}};
	struct image_signal signals[HEAP_SIGNALS];
	struct image_plan image = {.signals = signals,
	                           .signal_count = HEAP_SIGNALS,
	                           .targets = targets,
	                           .target_count = 2,
	                           .counters = counters,
	                           .counter_count = 2,
	                           .served = "owserver:/run/owsd/T.sock",
	                           .generation = 1,
	                           .start_id = 7,
	                           .pid = 1,
	                           .start_ns = HEAP_START,
	                           .period_ns = 100000000};
	uint8_t types[HEAP_SIGNALS];
	struct controller_plan plan = {.types = types,
	                               .signal_count = HEAP_SIGNALS,
	                               .text_cap = HEAP_TEXT,
	                               .generation = 1,
	                               .start_id = 7};
	struct controller_memory controller = {.layout = &heap.layout};
	const struct ows_who who = {.serial = 1, .pid = 1, .name = "plc", .person = "Anna"};
	struct ows_journal_entry command = {.record = 2, .kind = OWS_REASON_SET, .who = who};
	struct ows_shelf_entry shelf = {.record = 1, .who = who, .why = "moved"};
	struct ows_journal_entry alarm = {.record = 1,
	                                  .occurred_ns = HEAP_START,
	                                  .kind = OWS_ALARM_H,
	                                  .flags = OWS_JOURNAL_BEFORE};

	for (unsigned i = 0; i < HEAP_SIGNALS; i++) {
		types[i] = heap_signals[i].type;
		signals[i] = (struct image_signal){
			.name = heap_signals[i].name,
			.path = heap_signals[i].path,
			.type = heap_signals[i].type,
			.per_factor = i + 1,
			.flags = is_output[i] ? OWS_RECORD_OUTPUT : 0,
			.text_cap = heap_signals[i].type == OWS_STRING ? HEAP_TEXT : 0};
	}
	heap.image_size = image_size(&image);
	TEST_ASSERT_EQUAL_INT(0, controller_layout_make(&heap.layout, &plan));
	heap.controller_size = heap.layout.header.size;
	heap.image_memory = zeroed(heap.image_size);
	heap.controller_memory = controller.base = zeroed(heap.controller_size);
	image_build(&image, heap.image_memory, &heap.image);
	controller_build(&controller, 1);
	for (unsigned i = 0; i <= HEAP_SIGNALS; i++)
		controller_allow(&controller, i, true);
	image_state(&heap.image, OWS_STATE_LIVE);
	controller_state(&controller, OWS_STATE_LIVE);
	heap_beat(HEAP_START);
	for (unsigned i = 0; i < HEAP_SIGNALS; i++)
		heap_put(i + 1,
		         heap_signals[i].type == OWS_DOUBLE || heap_signals[i].type == OWS_FLOAT
		                 ? value_of_double(21.5)
		                 : 1,
		         "boiler", HEAP_START, 0);
	image_alarm(&heap.image, &alarm);
	image_command(&heap.image, &command);
	image_shelf(&heap.image, 0, &shelf);
	for (unsigned i = 0; i < 2; i++)
		image_target(&heap.image, i, 1, i);
	image_then = memcpy(zeroed(heap.image_size), heap.image_memory, heap.image_size);
	controller_then = memcpy(zeroed(heap.controller_size), heap.controller_memory,
	                         heap.controller_size);
}

void heap_instance_reset(void)
{
	setenv("OWS_DIR", "/dev/null/owsd", 1); /* no directory of this machine is looked at */
	if (!image_then)
		make();
	memcpy(heap.image_memory, image_then, heap.image_size);
	memcpy(heap.controller_memory, controller_then, heap.controller_size);
	heap_image_file = (struct heap_file){heap.image_memory, heap.image_size};
	heap_controller_file = (struct heap_file){heap.controller_memory, heap.controller_size};
}
