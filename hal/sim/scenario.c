/* SPDX-License-Identifier: MIT */
/*
 * The parser of the scenario language, which makes a simulated network of a text. A line's first
 * word decides what the line is. The first error stays in struct words and no word is read after
 * it, so the functions of the lines look for it only where they would do damage.
 */
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/base/file.h"
#include "hal/owfs/path.h"
#include "hal/sim/branch.h"
#include "hal/sim/button.h"
#include "hal/sim/event.h"
#include "hal/sim/families.h"
#include "hal/sim/scenario.h"

#define MAX_FILE 1000000

struct scenario {
	struct sim_net *net;
	unsigned channel;          /* for the devices that follow */
	struct sim_slave *coupler; /* they are behind its branch; NULL: on the channel itself */
	enum sim_branch_number branch;
	bool adapter; /* the line of the adapter was there */
	bool nomem;
};

static void i2c_line(struct scenario *scenario, struct words *words)
{
	static const struct {
		const char *name;
		enum sim_combine combine;
	} kinds[] = {{"smbus", SIM_SMBUS_ONLY},
	             {"one-read", SIM_ONE_READ_LAST},
	             {"any", SIM_ANY_MESSAGES}};
	struct sim_net *net = scenario->net;

	if (scenario->adapter)
		words_fail(words, "there is an i2c line already");
	scenario->adapter = true;
	while (words_next(words)) {
		if (strcmp(words->word, "speed") == 0) {
			net->hz = (uint32_t)(words_number(words, "the speed in kHz", 10, 1000) *
			                     1000);
		} else if (strcmp(words->word, "messages") == 0) {
			net->max_messages = (unsigned)words_number(words, "the count", 2, 42);
		} else if (strcmp(words->word, "combine") == 0) {
			unsigned i = 0;

			words_next(words);
			while (i < 3 && strcmp(words->word, kinds[i].name) != 0)
				i++;
			if (i == 3)
				words_fail(words, "\"%s\": expected any, one-read or smbus",
				           words->word);
			else
				net->combine = kinds[i].combine;
		} else {
			words_fail(words, "\"%s\": expected speed, combine or messages",
			           words->word);
		}
	}
}

static void chip_line(struct scenario *scenario, struct words *words)
{
	enum sim_part part = SIM_DS2482_100;
	uint8_t address;
	int err;

	words_next(words);
	while (part <= SIM_DS2484 && strcasecmp(words->word, sim_part_name(part)) != 0)
		part++;
	if (part > SIM_DS2484) {
		words_fail(words,
		           "\"%s\": expected DS2482-100, DS2482-101, DS2482-800, DS2483 or "
		           "DS2484",
		           words->word);
		return;
	}
	address = (uint8_t)words_number(words, "the I2C address", 0x18, 0x1F);
	if (words->failed)
		return;
	err = sim_net_add_chip(scenario->net, part, address);
	if (err)
		words_fail(words, err == -EEXIST ? "there is a chip at this address already"
		                                 : "there are too many chips");
	scenario->channel = 0;
	scenario->coupler = NULL;
	if (words_take(words, "times"))
		scenario->net->chip[scenario->net->chips - 1].percent = (int)words_number(
			words, "the 1-Wire times in percent", 95, 105);
	words_end(words);
}

static void channel_line(struct scenario *scenario, struct words *words)
{
	const struct sim_net *net = scenario->net;

	if (net->chips == 0) {
		words_fail(words, "a channel needs a chip before it");
		return;
	}
	scenario->channel = (unsigned)words_number(words, "the channel", 0,
	                                           net->chip[net->chips - 1].channels - 1);
	scenario->coupler = NULL;
	words_end(words);
}

static void branch_line(struct scenario *scenario, struct words *words)
{
	const struct sim_net *net = scenario->net;
	struct sim_slave *coupler;

	words_next(words);
	coupler = sim_net_slave(net, words->word);
	if (!coupler || !coupler->branches || coupler->chip != net->chips - 1) {
		words_fail(words, "\"%s\": expected the name of a DS2409 of the last chip",
		           words->word);
		return;
	}
	words_next(words);
	if (strcmp(words->word, "main") != 0 && strcmp(words->word, "aux") != 0)
		words_fail(words, "\"%s\": expected main or aux", words->word);
	scenario->coupler = coupler;
	scenario->branch = strcmp(words->word, "aux") == 0 ? SIM_AUX : SIM_MAIN;
	scenario->channel = coupler->channel;
	words_end(words);
}

static void fill_memory(struct sim_slave *slave, struct words *words)
{
	size_t size, at;
	uint8_t *memory = sim_slave_memory(slave, &size);

	if (!memory) {
		words_fail(words, "a %s has no memory to fill", slave->family->name);
		return;
	}
	at = (size_t)words_number(words, "the address", 0, (double)size - 1);
	words_next(words);
	for (const char *hex = words->word; !words->failed && *hex; hex += 2, at++) {
		const char digits[3] = {hex[0], hex[1]};

		if (!isxdigit((unsigned char)hex[0]) || !isxdigit((unsigned char)hex[1]))
			words_fail(words, "\"%s\": expected bytes as hexadecimal digits",
			           words->word);
		else if (at >= size)
			words_fail(words, "the memory ends at 0x%zx", size - 1);
		else
			memory[at] = (uint8_t)strtoul(digits, NULL, 16);
	}
}

/* Parse the properties of a device, which follow its name. */
static void properties(struct sim_slave *slave, struct words *words)
{
	while (words_next(words)) {
		int input = sim_slave_input(slave, words->word);
		char name[sizeof(words->word)];
		int err;

		if (input >= 0) {
			slave->input[input] = words_curve(words, &slave->family->inputs[input]);
			continue;
		}
		if (strcmp(words->word, "parasite") == 0) {
			slave->parasite = true;
			continue;
		}
		if (strcmp(words->word, "unplugged") == 0) {
			slave->plugged = false;
			continue;
		}
		if (strcmp(words->word, "memory") == 0) {
			fill_memory(slave, words);
			continue;
		}
		memcpy(name, words->word, sizeof(name));
		if (sim_slave_option(slave, name, 0) == -ENOENT) {
			words_fail(words, "a %s has no \"%s\"", slave->family->name, name);
			return;
		}
		err = sim_slave_option(slave, name, words_number(words, name, -1e9, UINT32_MAX));
		if (err)
			words_fail(words, "%s is out of the range of %s", words->word, name);
	}
}

static void add_device(struct scenario *scenario, const struct sim_family *family,
                       const uint8_t rom[ROM_LEN], struct words *words)
{
	struct sim_net *net = scenario->net;
	struct sim_slave *slave = sim_slave_create(family, rom + 1);
	unsigned chip = net->chips - 1;

	if (!slave || sim_net_add_slave(net, chip, scenario->channel, slave)) {
		sim_slave_destroy(slave);
		scenario->nomem = true;
		return;
	}
	if (scenario->coupler)
		sim_branch_put(slave, scenario->coupler, scenario->branch);
	rom_print(rom, ROM_F_I, slave->name);
	if (words_take(words, "as")) {
		words_next(words);
		if (!isalpha((unsigned char)words->word[0]) ||
		    strlen(words->word) >= sizeof(slave->name))
			words_fail(words, "\"%s\": expected a name: a letter first, %zu at most",
			           words->word, sizeof(slave->name) - 1);
		else if (sim_net_slave(net, words->word))
			words_fail(words, "there is a device \"%s\" already", words->word);
		else
			memcpy(slave->name, words->word, strlen(words->word) + 1);
	}
	properties(slave, words);
}

static bool on_wires(const struct sim_chip *chip, const uint8_t rom[ROM_LEN])
{
	for (unsigned channel = 0; channel < chip->channels; channel++) {
		const struct sim_wire *wire = &chip->wire[channel];

		for (size_t i = 0; i < wire->count; i++) {
			if (memcmp(wire->slaves[i]->rom, rom, ROM_LEN) == 0)
				return true;
		}
	}
	return false;
}

static void device_line(struct scenario *scenario, const struct sim_family *family,
                        struct words *words)
{
	char text[ROM_TEXT_MAX];
	uint8_t rom[ROM_LEN];
	int err;

	if (scenario->net->chips == 0) {
		words_fail(words, "a device needs a chip before it");
		return;
	}
	words_next(words);
	err = rom_parse(words->word, strlen(words->word), rom);
	if (err) {
		words_fail(words,
		           err == -EBADMSG ? "\"%s\": its CRC is wrong"
		                           : "\"%s\": expected a ROM id, as 28.0000000000A1",
		           words->word);
		return;
	}
	if (rom[0] != family->code) {
		words_fail(words, "a %s has family code %02X, not %02X", family->name, family->code,
		           rom[0]);
		return;
	}
	rom_print(rom, ROM_F_I, text);
	if (sim_net_slave(scenario->net, text) ||
	    on_wires(&scenario->net->chip[scenario->net->chips - 1], rom)) {
		words_fail(words, "there is a device %s already", text);
		return;
	}
	add_device(scenario, family, rom, words);
}

static void at_line(struct scenario *scenario, struct words *words)
{
	struct sim_event event[2] = {{0}};
	int64_t at = words_time(words, "a time");
	int64_t every = 0;
	unsigned n;

	if (words_take(words, "every")) {
		every = words_time(words, "the repetition");
		if (every < 1000)
			words_fail(words, "the repetition is 1us at least");
	}
	n = event_parse(scenario->net, words, event);
	for (unsigned i = 0; i < n && !words->failed; i++) {
		event[i].at_ns += at;
		event[i].every_ns = every;
		if (sim_net_add_event(scenario->net, &event[i]))
			scenario->nomem = true;
	}
}

/* Keywords come before names: a device's name cannot hide one. */
static void parse_line(struct scenario *scenario, struct words *words)
{
	const struct sim_family *family;
	struct sim_slave *slave;

	if (!words_next(words))
		return;
	family = sim_family_find(words->word, 0);
	slave = sim_net_slave(scenario->net, words->word);
	if (strcmp(words->word, "i2c") == 0)
		i2c_line(scenario, words);
	else if (strcmp(words->word, "chip") == 0)
		chip_line(scenario, words);
	else if (strcmp(words->word, "channel") == 0)
		channel_line(scenario, words);
	else if (strcmp(words->word, "branch") == 0)
		branch_line(scenario, words);
	else if (strcmp(words->word, "at") == 0)
		at_line(scenario, words);
	else if (strcmp(words->word, "button") == 0)
		button_parse(scenario->net, words);
	else if (family)
		device_line(scenario, family, words);
	else if (slave)
		properties(slave, words);
	else
		words_fail(words,
		           "\"%s\": expected i2c, chip, channel, branch, at, button, a part such "
		           "as DS18B20, or the name of a device",
		           words->word);
}

int sim_scenario_parse(const char *name, const char *text, struct sim_net *net, char *why,
                       size_t why_size)
{
	struct scenario scenario = {.net = net};
	struct words words = {0};

	sim_net_init(net);
	for (unsigned line = 1; *text && !words.failed && !scenario.nomem; line++) {
		words_init(&words, name, line, text, why, why_size);
		parse_line(&scenario, &words);
		text += strcspn(text, "\n");
		text += *text == '\n';
	}
	if (!words.failed && !scenario.nomem && net->chips == 0) {
		words_init(&words, name, 0, "", why, why_size);
		words_fail(&words, "no chip in it");
	}
	if (!words.failed && !scenario.nomem)
		return 0;
	sim_net_clear(net);
	return scenario.nomem ? -ENOMEM : -EINVAL;
}

int sim_scenario_read(const char *file, struct sim_net *net, char *why, size_t why_size)
{
	int err;
	char *text = file_text(file, MAX_FILE, &err, why, why_size);

	if (!text)
		return err;
	err = sim_scenario_parse(file, text, net, why, why_size);
	free(text);
	return err;
}
