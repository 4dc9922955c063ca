/* SPDX-License-Identifier: MIT */
/*
 * Controllers command, owsd takes: the code of src/memory/libows/set.c and command.c, of
 * src/memory/shm/controller.c, and the sleep of src/daemon/host/engine_thread.c and bells.c.
 */
#include "src/daemon/host/engine_thread.c"

#include <math.h>
#include <poll.h>

#include "src/daemon/engine/state.h"
#include "src/memory/control/news.h"
#include "src/memory/control/private.h"
#include "src/memory/libows/handle.h"
#include "tests/model/suites.h"

#define NUMBER 1 /* records */
#define STRING 2
#define RECORDS 3
#define TEXT 8
#define CONTROLLERS 2

static _Alignas(64) char memories[CONTROLLERS][4096], next_memory[4096];
static struct controller_layout layout;
static struct controller_memory controllers[CONTROLLERS], next;
static struct ows handles[CONTROLLERS];
static struct ows_memory attributes[1];
static struct ows_id ids[2];
static struct ows_record records[RECORDS];
static struct ows_info_entry infos[RECORDS]; /* without Min and Max */
static struct ows_image_header header;
static struct engine engine;
static struct serving serving;
static struct host host;
static struct control control;
static uint32_t rings, news_rings, due_rings, message;

/* What the threads found out; put aside and back with them. */
static struct {
	struct controller_command got[CONTROLLERS]; /* by owsd, last */
	char text[TEXT + 1];
	bool text_got;
	int err[CONTROLLERS]; /* of the programs' calls */
	uint32_t acknowledged, message, shelf;
	/* of the bells, by the engine's thread, by a controller, by the thread of news */
	uint32_t heard, heard_news, heard_due;
	int64_t now_ns; /* the clock; it goes on when somebody naps */
} found;

int64_t __wrap_ows_now(void);
int __wrap_nanosleep(const struct timespec *time, struct timespec *left);

int64_t __wrap_ows_now(void)
{
	static int64_t ticks; /* never twice the same; no thread asks how long it takes */

	return found.now_ns + ++ticks % NS_PER_S;
}

int __wrap_nanosleep(const struct timespec *time, struct timespec *left)
{
	(void)time;
	(void)left;
	found.now_ns += 10 * NS_PER_S;
	return 0;
}

static int64_t number_of(unsigned n)
{
	return (int64_t)(0x0000000100000001u) * (n + 1);
}

static const char *text_of(unsigned n)
{
	return n == 0 ? "1111" : "222";
}

static struct ows_controller_header *header_of(unsigned controller)
{
	return (void *)memories[controller];
}

static struct ows_command_slot *slot_of(char *memory, uint32_t record)
{
	return (struct ows_command_slot *)(void *)(memory + layout.header.slot_off) + record;
}

static void make_layout(void)
{
	static const uint8_t types[] = {OWS_LARGE, OWS_STRING};
	static const struct controller_plan plan = {
		.types = types, .signal_count = 2, .text_cap = TEXT};

	if (!layout.header.size &&
	    (controller_layout_make(&layout, &plan) || layout.header.size > 4096))
		abort();
}

static void make_memory(char *where, struct controller_memory *made, uint32_t serial)
{
	memset(where, 0, 4096);
	*made = (struct controller_memory){where, &layout};
	controller_build(made, serial);
	controller_allow(made, NUMBER, true);
	controller_allow(made, STRING, true);
	controller_state(made, OWS_STATE_LIVE);
}

static void make_handle(unsigned i)
{
	handles[i] = (struct ows){
		.map = {.image = &header, .base = (char *)&header, .count = RECORDS},
		.give = {.base = memories[i], .header = layout.header},
		.join = {.connection = -1, .bell = ACCESS_BELL, .news = -1},
		.mode = OWS_CONTROL,
		.alive_now = -1,
		.dead_after_ns = INT64_MAX,
		.ids = ids,
		.id_count = 2,
		.memories = attributes,
		.memory_count = 1,
	};
	handles[i].map.areas[OWS_AREA_RECORDS] = (struct map_area){
		.base = (const char *)records, .size = sizeof(records[0]), .count = RECORDS};
	for (unsigned r = 0; r < RECORDS; r++)
		infos[r].min = infos[r].max = NAN;
	handles[i].map.areas[OWS_AREA_INFOS] = (struct map_area){
		.base = (const char *)infos, .size = sizeof(infos[0]), .count = RECORDS};
	explore_keep(&handles[i].stamp, sizeof(handles[i].stamp));
}

static void setup(void)
{
	make_layout();
	memset(&found, 0, sizeof(found));
	explore_keep(&found, sizeof(found));
	header = (struct ows_image_header){.state = OWS_STATE_LIVE, .awake = 1};
	records[NUMBER] = (struct ows_record){.type = OWS_LARGE, .flags = OWS_RECORD_OUTPUT};
	records[STRING] = (struct ows_record){.type = OWS_STRING, .flags = OWS_RECORD_OUTPUT};
	ids[0] = (struct ows_id){.record = NUMBER, .attribute = ATTR_VALUE};
	ids[1] = (struct ows_id){.record = STRING, .attribute = ATTR_VALUE};
	memset(&engine, 0, sizeof(engine));
	for (unsigned i = 0; i < CONTROLLERS; i++) {
		make_memory(memories[i], &controllers[i], i + 1);
		make_handle(i);
		engine.controllers[i].is = CONTROLLER_CONNECTED;
		engine.controllers[i].as.memory = controllers[i];
		engine.seat_end = i + 1;
	}
	serving.engine = &engine;
	serving.memory.image.header = &header;
	host.now = &serving;
	host.bells = (struct bells){.own = ACCESS_BELL, .awake = 1};
	rings = news_rings = due_rings = message = 0;
	access_bell(ACCESS_BELL, &rings, &found.heard);
	access_bell(ACCESS_NEWS, &news_rings, &found.heard_news);
	access_bell(ACCESS_ORDERING, &due_rings, &found.heard_due);
	explore_track("rings", &rings, 4);
}

static void track_marks(unsigned controller)
{
	explore_track(controller ? "dirty 1" : "dirty", give_dirty(&handles[controller].give, 0),
	              4);
	explore_track(controller ? "marked 1" : "marked", &header_of(controller)->marked, 4);
}

static void setup_number(void)
{
	struct ows_command_slot *slot;

	setup();
	slot = slot_of(memories[0], NUMBER);
	explore_track("awake", &header.awake, 4);
	explore_track("value", &slot->value, 8);
	explore_track("stamp", &slot->stamp, 4);
	track_marks(0);
}

static void setup_controllers(void)
{
	setup();
	explore_track("awake", &header.awake, 4);
	track_marks(0);
	track_marks(1);
}

static void setup_text(void)
{
	struct ows_command_text *text;

	setup();
	text = give_text(&handles[0].give, STRING);
	explore_track("awake", &header.awake, 4);
	explore_track("stamp", &slot_of(memories[0], STRING)->stamp, 4);
	explore_track("len", &text->len, 4);
	explore_track("check", &text->check, 4);
	explore_track("text", (uint32_t *)(void *)(text + 1), 4);
	track_marks(0);
}

/* --- Controllers
 * ----------------------------------------------------------------------------------- */

static void set_number(unsigned controller, unsigned n)
{
	found.err[controller] = ows_set_integer(&handles[controller], 0, number_of(n), NULL);
}

static void controller_0(void)
{
	set_number(0, 0);
}

static void controller_1(void)
{
	set_number(1, 0);
}

static void controller_twice(void)
{
	set_number(0, 0);
	explore_forget(1);
	set_number(0, 1);
}

static void controller_texts(void)
{
	found.err[0] = ows_set_text(&handles[0], 1, text_of(0), NULL);
	explore_forget(1);
	found.err[0] |= ows_set_text(&handles[0], 1, text_of(1), NULL);
}

static void nobody(void)
{
}

/* --- owsd ------------------------------------------------------------------------------------- */

/* As a look of src/daemon/engine/command/intake.c: the mark, the slots, their contents. */
static bool is_marked(unsigned controller, uint32_t record)
{
	controller_marked(&controllers[controller]);
	return controller_next_dirty(&controllers[controller], 0) == (int)record;
}

static void look_at_number(unsigned controller)
{
	struct controller_command *got = &found.got[controller];

	if (!is_marked(controller, NUMBER))
		return;
	controller_load(&controllers[controller], NUMBER, got);
	if (got->value != 0 && got->value != number_of(0) && got->value != number_of(1))
		explore_fail("value %#llx, which nobody set", (unsigned long long)got->value);
	if (got->stamp > 0 && got->value < number_of(got->stamp - 1))
		explore_fail("stamp %u before its value", got->stamp);
}

static void look_at_one(void)
{
	look_at_number(0);
}

static void look_at_both(void)
{
	for (unsigned i = 0; i < CONTROLLERS; i++) {
		found.got[i].fresh |= is_marked(i, NUMBER);
		explore_forget(i);
	}
}

static void look_at_text(void)
{
	int len;

	if (!is_marked(0, STRING))
		return;
	controller_load(&controllers[0], STRING, &found.got[0]);
	len = controller_text(&controllers[0], STRING, found.text);
	found.text_got = len >= 0;
	if (len < 0)
		memset(found.text, 0, sizeof(found.text));
	else if (found.got[0].stamp != 0 && strcmp(found.text, text_of(0)) != 0 &&
	         strcmp(found.text, text_of(1)) != 0)
		explore_fail("text '%s', which nobody set", found.text);
}

/* The loop of engine_main() in src/daemon/host/engine_thread.c, as far as commands go. */
static void run_engine(void (*look)(void))
{
	for (;;) {
		bells_look(&host.bells);
		look();
		explore_forget(0);
		sleep_until(&host, INT64_MAX);
		explore_forget(0);
	}
}

static void engine_one(void)
{
	run_engine(look_at_one);
}

static void engine_both(void)
{
	run_engine(look_at_both);
}

static void engine_text(void)
{
	run_engine(look_at_text);
}

/* owsd sleeps, and must have the last of all commands. */
static void number_taken(void)
{
	const struct ows_command_slot *slot = slot_of(memories[0], NUMBER);

	if (found.err[0])
		explore_fail("a set returned %d", found.err[0]);
	if (found.got[0].stamp != 2 || explore_last(&slot->stamp) != 2)
		explore_fail("owsd sleeps on stamp %u of 2", found.got[0].stamp);
	if ((uint64_t)found.got[0].value != explore_last(&slot->value))
		explore_fail("owsd sleeps on an older value");
}

static void both_taken(void)
{
	for (unsigned i = 0; i < CONTROLLERS; i++)
		if (found.err[i] || !found.got[i].fresh)
			explore_fail("owsd sleeps on the set of controller %u", i);
}

static void text_taken(void)
{
	if (found.err[0])
		explore_fail("a set returned %d", found.err[0]);
	if (found.got[0].stamp != 2)
		explore_fail("owsd sleeps on stamp %u of 2", found.got[0].stamp);
	if (!found.text_got || strcmp(found.text, text_of(1)) != 0)
		explore_fail("owsd sleeps on the text '%s'", found.text);
}

/* --- A reload --------------------------------------------------------------------------------- */

static void setup_reload(void)
{
	setup_number();
	explore_track("state", &header_of(0)->state, 4);
	make_memory(next_memory, &next, 1);
	explore_keep(slot_of(next_memory, NUMBER), sizeof(struct ows_command_slot));
	explore_keep(&slot_of(memories[0], NUMBER)->taken, 3 * sizeof(uint32_t));
}

/* Retire, look for the last time, carry what lies there into the next memory. */
static void reload(void)
{
	static const uint32_t rows[] = {NUMBER - 1, STRING - 1};

	controller_state(&controllers[0], OWS_STATE_RETIRED);
	look_at_one();
	if (found.got[0].stamp)
		controller_taken(&controllers[0], NUMBER, found.got[0].stamp, 0);
	explore_forget(0);
	controller_copy(&next, &controllers[0], rows);
}

/* If the controller was told that all is well, owsd has taken it, and the next memory has it. */
static void carried(void)
{
	const struct ows_command_slot *slot = slot_of(next_memory, NUMBER);

	if (slot->taken != slot->stamp)
		explore_fail("a command that was refused comes to life");
	if (found.err[0] != 0 && found.err[0] != -ESTALE)
		explore_fail("a set returned %d", found.err[0]);
	if (found.err[0] == 0 && (found.got[0].stamp != 1 || slot->stamp != 1 || slot->err))
		explore_fail("the set returned that all is well, and is lost");
	if (slot->stamp == 1 && !slot->err && found.got[0].stamp != 1)
		explore_fail("a command that owsd has not taken seems to be");
}

/* --- Acknowledgements, beats, shelving -------------------------------------------------------- */

static void setup_acknowledgement(void)
{
	struct ows_command_slot *slot;

	setup();
	slot = slot_of(memories[0], NUMBER);
	explore_track("awake", &header.awake, 4);
	explore_track("acknowledged", &slot->acknowledged, 4);
	explore_track("person", &slot->person, 4);
	track_marks(0);
	explore_keep(slot->spare0, sizeof(slot->spare0));
}

static void controller_acknowledges(void)
{
	handles[0].person = 3;
	ows_acknowledge(&handles[0], 0);
}

static void look_for_acknowledgement(void)
{
	struct controller_command c;

	if (!is_marked(0, NUMBER))
		return;
	controller_load(&controllers[0], NUMBER, &c);
	found.acknowledged += c.acknowledged;
}

static void engine_acknowledged(void)
{
	run_engine(look_for_acknowledgement);
}

static void acknowledged_once(void)
{
	if (found.acknowledged != 1)
		explore_fail("acknowledged %u times", found.acknowledged);
}

static void setup_beat(void)
{
	setup();
	explore_track("beat", &header_of(0)->beat, 4);
	explore_track("period", &header_of(0)->period_ms, 4);
}

static void controller_beats(void)
{
	if (ows_beat(&handles[0], 500))
		explore_fail("a beat failed");
}

static void hear_beat(void)
{
	struct controller_beat beat;

	controller_beat(&controllers[0], &beat);
	if (beat.beat != 0 && beat.period_ms != 500)
		explore_fail("a beat before its promise");
}

static void setup_shelf(void)
{
	struct ows_command_shelf *shelf;

	setup();
	shelf = give_shelf(&handles[0].give);
	explore_track("awake", &header.awake, 4);
	explore_track("marked", &header_of(0)->marked, 4);
	explore_track("count", &shelf->count, 4);
	explore_track("seconds", &shelf->seconds, 4);
	explore_track("why", (uint32_t *)(void *)shelf->why, 4);
	explore_track("done", &shelf->done, 4);
	explore_track("err", &shelf->err, 4);
}

static void controller_shelves(void)
{
	int err = ows_shelve(&handles[0], 0, 60, "why");

	if (err != -ENOSPC && err != -ETIMEDOUT)
		explore_fail("the answer to a shelving is %d", err);
}

static void look_at_shelf(void)
{
	struct controller_shelf shelf;

	controller_marked(&controllers[0]);
	if (!controller_shelf(&controllers[0], &shelf))
		return;
	if (shelf.seconds != 60 || strcmp(shelf.why, "why") != 0)
		explore_fail("a request before its words");
	found.shelf = shelf.count;
	controller_shelf_done(&controllers[0], shelf.count, -ENOSPC);
}

static void engine_shelves(void)
{
	run_engine(look_at_shelf);
}

static void shelved(void)
{
	if (found.shelf != 1)
		explore_fail("owsd sleeps on a request to shelve");
}

/* --- owsd's own threads ----------------------------------------------------------------------- */

static void setup_own(void)
{
	setup();
	explore_track("message", &message, 4);
	explore_track("rung", &host.bells.rung, 4);
	explore_track("eyes", &host.bells.awake, 4);
}

/* A worker has an answer for the engine. */
static void worker(void)
{
	for (uint32_t n = 1; n <= 2; n++) {
		word_set(&message, n);
		host_ring(&host);
		explore_forget(n);
	}
}

static void look_at_message(void)
{
	found.message = word_get(&message);
}

static void engine_own(void)
{
	run_engine(look_at_message);
}

static void message_taken(void)
{
	if (found.message != 2)
		explore_fail("asleep on message %u of 2", found.message);
}

/* --- News for a controller, and for a reader
 * ------------------------------------------------------ */

static uint32_t last_message;

static void setup_news(void)
{
	setup();
	last_message = 1; /* with two the controller makes ten million states */
	explore_track("message", &message, 4);
	explore_track("news", &header.news, 4);
	explore_track("waits", &header_of(0)->waits, 4);
	explore_track("pipe", &news_rings, 4);
	explore_track("due rings", &due_rings, 4);
	handles[0].join.news = ACCESS_NEWS;
	memset(&control, 0, sizeof(control));
	control.engine.memories[0] = controllers[0];
	control.engine.end = 1;
	control.seats[0].news = ACCESS_NEWS;
	news_begin(&control.seats[0]);
	control.news.bell = ACCESS_ORDERING;
	explore_track("due", &control.news.due[0], 4);
	explore_track("due image", &control.news.due[NEWS_IMAGE / 32], 4);
	explore_keep(&control.news.taken, sizeof(control.news.taken));
	explore_keep(&control.seats[0].news_state, sizeof(control.seats[0].news_state));
	host.control = &control;
}

static void setup_news_read(void)
{
	setup_news();
	last_message = 2;
	handles[0].join.news = -1;
}

/* A wake took long a moment ago: the engine leaves the next to the thread. */
static void setup_news_long(void)
{
	setup_news_read();
	control.engine.rest_until_ns = INT64_MAX;
}

static void engine_publishes(void)
{
	for (uint32_t n = 1; n <= last_message; n++) {
		word_set(&message, n);
		announce(&host);
		explore_forget(n);
	}
}

static void thread_rings(void)
{
	struct pollfd bell = {.fd = ACCESS_ORDERING, .events = POLLIN};
	const struct timespec long_ns = {.tv_sec = 1};

	for (;;) {
		ppoll(&bell, 1, &long_ns, NULL);
		news_turn(&control);
		explore_forget(found.heard_due);
	}
}

static void program_waits_for_news(void)
{
	uint32_t news = 0;

	while (ows_wait(&handles[0], &news, -1) > 0) {
		found.message = word_get(&message);
		if (found.message < news)
			explore_fail("woken by news %u, found message %u", news, found.message);
		explore_forget(news);
	}
}

static void last_message_taken(void)
{
	if (found.message != last_message)
		explore_fail("asleep on message %u of %u", found.message, last_message);
}

/* clang-format off */
const struct scenario command_scenarios[] = {
	{"a controller sets twice, owsd sleeps between", setup_number, 2, {engine_one, controller_twice},
	 .end = number_taken},
	{"two controllers set", setup_controllers, 3, {engine_both, controller_0, controller_1}, .end = both_taken},
	{"a controller killed while it sets", setup_number, 2, {engine_one, controller_twice},
	 {NULL, nobody}, NULL},
	{"a controller sets a text twice", setup_text, 2, {engine_text, controller_texts}, .end = text_taken},
	{"a set while owsd reloads", setup_reload, 2, {reload, controller_0}, .end = carried},
	{"an acknowledgement", setup_acknowledgement, 2, {engine_acknowledged, controller_acknowledges},
	 .end = acknowledged_once},
	{"a beat and its promise", setup_beat, 2, {hear_beat, controller_beats}, .end = NULL},
	{"a request to shelve, and its answer", setup_shelf, 2, {engine_shelves, controller_shelves},
	 .end = shelved},
	{"a thread of owsd wakes the engine's", setup_own, 2, {engine_own, worker},
	 .end = message_taken},
	{"a controller waits for news", setup_news, 3,
	 {engine_publishes, program_waits_for_news, thread_rings}, .end = last_message_taken},
	{"a reader waits for news", setup_news_read, 3,
	 {engine_publishes, program_waits_for_news, thread_rings}, .end = last_message_taken},
	{"a reader waits for news of the thread", setup_news_long, 3,
	 {engine_publishes, program_waits_for_news, thread_rings}, .end = last_message_taken},
	{NULL},
};
/* clang-format on */
