/* SPDX-License-Identifier: MIT */
/*
 * Control programs set, owsd takes: the code of src/libows/set.c, src/shm/commands.c,
 * src/shm/carry.c, and the sleep of src/host/engine_thread.c.
 */
#include "src/host/engine_thread.c"
#include "src/libows/handle.h"
#include "src/shm/carry.h"
#include "src/shm/commands.h"
#include "tests/model/suites.h"

#define NUMBER 1 /* slots */
#define STRING 2
#define TEXT 8

static _Alignas(64) char memory[8192], next_memory[8192];
static struct commands commands, next;
static struct ows handles[2];
static struct ows_id ids[2];
static struct ows_record records[3];
static struct serving serving;
static struct host host;

/* What the threads found out. */
static struct {
	struct command got; /* by owsd, last */
	char text[TEXT + 1];
	bool text_got;
	int err[2];    /* of the programs' sets */
	uint32_t news; /* another value: owsd has seen all that it can */
} found;

static int64_t number_of(unsigned program)
{
	return (int64_t)(0x0000000100000001u) * (program + 1);
}

static const char *text_of(unsigned program)
{
	return program == 0 ? "1111" : "222";
}

static void make_commands(char *where, struct commands *made)
{
	static const struct command_signal signals[] = {
		{"number", "/x", OWS_LARGE},
		{"string", "/y", OWS_STRING},
	};
	static const struct command_plan plan = {
		.signals = signals, .signal_count = 2, .text_cap = TEXT};

	commands_forget(made);
	memset(where, 0, sizeof(memory));
	if (commands_build(&plan, where, made) < 0)
		abort();
	commands_state(made, OWS_STATE_LIVE);
	commands_awake(made, true);
}

static struct ows_command_slot *slot_of_next(void)
{
	return (struct ows_command_slot *)(void *)(next_memory + next.slot_off) + NUMBER;
}

static void setup(void)
{
	struct ows_command_header *header = (void *)memory;
	struct ows_command_slot *slots;

	make_commands(memory, &commands);
	make_commands(next_memory, &next);
	slots = (void *)(memory + commands.slot_off);
	records[NUMBER] = (struct ows_record){.type = OWS_LARGE, .flags = OWS_RECORD_OUTPUT};
	records[STRING] = (struct ows_record){.type = OWS_STRING, .flags = OWS_RECORD_OUTPUT};
	ids[0] = (struct ows_id){.record = NUMBER, .attribute = ATTR_VALUE};
	ids[1] = (struct ows_id){.record = STRING, .attribute = ATTR_VALUE};
	for (uint32_t i = 0; i < 2; i++)
		handles[i] = (struct ows){
			.map =
				{
					.records = records,
					.record_size = sizeof(records[0]),
					.count = 3,
					.command = header,
					.slots = slots,
					.entries = (void *)(memory + commands.entry_off),
					.dirty = (void *)(memory + commands.dirty_off),
					.command_base = memory,
					.command_size = commands.size,
					.text_cap = TEXT,
				},
			.ids = ids,
			.id_count = 2,
			.client = -1,
			.pid = 100 + i,
		};
	serving.commands = &commands;
	host.now = &serving;
	host.bell = &header->bell;
	memset(&found, 0, sizeof(found));
	explore_keep(&found, sizeof(found));
	explore_track("dirty", handles[0].map.dirty, 4);
	explore_track("bell", &header->bell, 4);
	explore_track("awake", &header->awake, 4);
}

static void setup_number(void)
{
	struct ows_command_slot *slot;

	setup();
	slot = &handles[0].map.slots[NUMBER];
	explore_track("value", &slot->value, 8);
	explore_track("stamp", &slot->stamp, 4);
}

static void setup_text(void)
{
	struct ows_command_text *text;

	setup();
	text = (void *)(memory + commands.text_off[STRING]);
	explore_track("stamp", &handles[0].map.slots[STRING].stamp, 4);
	explore_track("claim", &text->claim, 4);
	explore_track("len", &text->len, 4);
	explore_track("check", &text->check, 4);
	explore_track("text", (uint32_t *)(void *)(text + 1), 4);
}

/* --- Control programs ------------------------------------------------------------------------- */

static void set_number(unsigned program)
{
	found.err[program] = ows_set_integer(&handles[program], 0, number_of(program), NULL);
}

static void set_text(unsigned program)
{
	found.err[program] = ows_set_text(&handles[program], 1, text_of(program), NULL);
}

static void program_0(void)
{
	set_number(0);
}

static void program_1(void)
{
	set_number(1);
}

/* Its second value is number_of(1), as its stamp then is 2. */
static void program_twice(void)
{
	set_number(0);
	explore_forget(1);
	found.err[0] = ows_set_integer(&handles[0], 0, number_of(1), NULL);
}

static void program_text_0(void)
{
	set_text(0);
}

static void program_text_1(void)
{
	set_text(1);
}

static void nobody(void)
{
}

/* --- owsd ------------------------------------------------------------------------------------- */

static void look_at_number(void)
{
	commands_load(&commands, NUMBER, &found.got);
	if (found.got.value != 0 && found.got.value != number_of(0) &&
	    found.got.value != number_of(1))
		explore_fail("value %#llx, which nobody set", (unsigned long long)found.got.value);
	if (found.got.stamp != 0 && found.got.value == 0)
		explore_fail("stamp %u before its value", found.got.stamp);
}

static void look_at_own_number(void)
{
	look_at_number();
	if (found.got.stamp > 0 && found.got.value < number_of(found.got.stamp - 1))
		explore_fail("stamp %u before its value", found.got.stamp);
}

static void look_at_text(void)
{
	int len;

	commands_load(&commands, STRING, &found.got);
	len = commands_text(&commands, STRING, found.text);
	found.text_got = len >= 0;
	if (len < 0)
		memset(found.text, 0, sizeof(found.text));
	else if (found.got.stamp != 0 && strcmp(found.text, text_of(0)) != 0 &&
	         strcmp(found.text, text_of(1)) != 0)
		explore_fail("text '%s', which nobody set", found.text);
}

/* The loop of engine_main() in src/host/engine_thread.c, as far as commands go. */
static void engine(void (*look)(void), uint32_t slot)
{
	for (;;) {
		uint32_t seen = __atomic_load_n(host.bell, __ATOMIC_ACQUIRE);

		if (commands_next_dirty(&commands, 0) == (int)slot)
			look();
		explore_forget(seen);
		sleep_until(&host, seen, INT64_MAX);
		explore_forget(0);
	}
}

static void engine_number(void)
{
	engine(look_at_number, NUMBER);
}

static void engine_own_number(void)
{
	engine(look_at_own_number, NUMBER);
}

static void engine_text(void)
{
	engine(look_at_text, STRING);
}

/* What a reload does: retire, look once more, carry what lies there into the next segment. */
static void reload(void)
{
	static const uint32_t rows[] = {NUMBER - 1, STRING - 1};

	commands_state(&commands, OWS_STATE_RETIRED);
	if (commands_next_dirty(&commands, 0) == NUMBER)
		look_at_number();
	explore_forget(0);
	commands_carry_rows(&next, &commands, rows);
}

/* What a start does with what a killed owsd has left. */
static void start_after_kill(void)
{
	commands_retire(memory, commands.size);
	commands_carry(&next, memory, commands.size, true);
}

static void setup_carry(void)
{
	setup_number();
	explore_track("state", &((struct ows_command_header *)(void *)memory)->state, 4);
	explore_keep(slot_of_next(), sizeof(struct ows_command_slot));
}

/* --- Ends ------------------------------------------------------------------------------------- */

static uint32_t last_stamp(uint32_t slot)
{
	return (uint32_t)explore_last(&handles[0].map.slots[slot].stamp);
}

/* owsd sleeps, and must have the last of all commands. */
static void number_taken(void)
{
	uint64_t last = explore_last(&handles[0].map.slots[NUMBER].value);

	if (found.got.stamp != last_stamp(NUMBER))
		explore_fail("owsd sleeps on stamp %u of %u", found.got.stamp, last_stamp(NUMBER));
	if ((uint64_t)found.got.value != last)
		explore_fail("owsd sleeps on an older value");
}

static void text_taken(void)
{
	if (found.got.stamp != last_stamp(STRING))
		explore_fail("owsd sleeps on stamp %u of %u", found.got.stamp, last_stamp(STRING));
	if (!found.text_got)
		explore_fail("owsd sleeps without the text");
	for (unsigned i = 0; i < 2; i++)
		if (!found.err[i] && found.err[1 - i] && strcmp(found.text, text_of(i)) != 0)
			explore_fail("owsd has '%s', set was '%s'", found.text, text_of(i));
}

/* If the program was told that all is well, the next segment has it. */
static void carried(void)
{
	const struct ows_command_slot *slot = slot_of_next();

	if (slot->value != 0 && slot->value != (uint64_t)number_of(0))
		explore_fail("carried %#llx, which nobody set", (unsigned long long)slot->value);
	if (slot->stamp == 1 && slot->value == 0)
		explore_fail("carried a stamp before its value");
	if (found.err[0] != 0 && found.err[0] != -ESTALE)
		explore_fail("a set said %d", found.err[0]);
	if (found.err[0] == 0 && (slot->stamp != 1 || slot->value == 0))
		explore_fail("the set said that all is well, and is lost");
}

/* clang-format off */
const struct scenario command_scenarios[] = {
	{"a program sets twice, owsd sleeps between", setup_number, 2,
	 {engine_own_number, program_twice}, .end = number_taken},
	{"two programs set one output", setup_number, 3, {engine_number, program_0, program_1},
	 .end = number_taken},
	{"a program killed while it sets", setup_number, 2, {engine_own_number, program_twice},
	 {NULL, nobody}, NULL},
	{"two programs set one text", setup_text, 3, {engine_text, program_text_0, program_text_1},
	 .end = text_taken},
	{"a set while owsd reloads", setup_carry, 2, {reload, program_0}, .end = carried},
	{"a set while owsd starts after a kill", setup_carry, 2, {start_after_kill, program_0},
	 .end = carried},
	{NULL},
};
/* clang-format on */
