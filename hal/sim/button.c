/* SPDX-License-Identifier: MIT */
/* The buttons of a simulated network: parsed from a scenario, read and written as properties. */
#include "hal/sim/button.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "hal/sim/event.h"

#define DIRECTORY "simulator"

/* Letters, digits, '_' and '-', a letter first: never two components of a path, or an element. */
static bool is_button_name(const char *text)
{
	size_t len = strlen(text);

	if (!isalpha((unsigned char)text[0]) || len >= SIM_BUTTON_NAME)
		return false;
	for (size_t i = 0; i < len; i++)
		if (!isalnum((unsigned char)text[i]) && text[i] != '_' && text[i] != '-')
			return false;
	return true;
}

static struct sim_button *button_find(struct sim_net *net, const char *name, size_t len)
{
	for (unsigned i = 0; i < net->buttons; i++) {
		struct sim_button *button = &net->button[i];

		if (strlen(button->name) == len && memcmp(button->name, name, len) == 0)
			return button;
	}
	return NULL;
}

void button_parse(struct sim_net *net, struct words *words)
{
	struct sim_event event[2] = {{0}};
	struct sim_button *button = &net->button[net->buttons];
	unsigned n, column;

	words_next(words);
	column = words->column;
	if (net->buttons == SIM_MAX_BUTTONS) {
		words_fail(words, "there are %d buttons already", SIM_MAX_BUTTONS);
		return;
	}
	if (!is_button_name(words->word)) {
		words_fail(words,
		           "\"%s\": expected a name: a letter, then letters, digits, _ and -, %d "
		           "at most",
		           words->word, SIM_BUTTON_NAME - 1);
		return;
	}
	if (button_find(net, words->word, strlen(words->word))) {
		words_fail(words, "there is a button \"%s\" already", words->word);
		return;
	}
	memcpy(button->name, words->word, strlen(words->word) + 1);
	n = event_parse(net, words, event);
	if (!n)
		return;
	if (n > 1 || !event_is_held(&event[0])) {
		words->column = column;
		words_fail(words, "a button has unplug, corrupt or short, without end and for: a 0 "
		                  "that is written ends it");
		return;
	}
	button->event = event[0];
	net->buttons++;
}

static int button_list(const struct sim_net *net, struct bus_req *req, struct bus_answer *answer)
{
	for (unsigned i = 0; i < net->buttons; i++) {
		char line[sizeof("/" DIRECTORY "/\n") + SIM_BUTTON_NAME];
		int n = snprintf(line, sizeof(line), "/" DIRECTORY "/%s\n", net->button[i].name);

		if ((uint32_t)n > req->len - answer->len)
			return -EMSGSIZE;
		memcpy(req->data + answer->len, line, (size_t)n);
		answer->len += (uint32_t)n;
	}
	return 0;
}

static int answer_directory(const struct sim_net *net, struct bus_req *req,
                            struct bus_answer *answer)
{
	switch ((enum bus_op)req->op) {
	case BUS_DIR:
		return button_list(net, req, answer);
	case BUS_PROBE:
		return 0;
	case BUS_READ:
	case BUS_WRITE:
		break;
	}
	return -EISDIR;
}

static int read_state(const struct sim_net *net, const struct sim_button *button,
                      struct bus_req *req, struct bus_answer *answer)
{
	bool lasts = sim_net_lasts(net, &button->event);

	answer->kind = BUS_NUMBER;
	answer->number = lasts;
	if (req->number)
		return 0;
	if (!req->len)
		return -EMSGSIZE;
	req->data[0] = lasts ? '1' : '0';
	answer->len = 1;
	return 0;
}

/* To press a button whose event lasts already, by itself or by another event, has no effect. */
static int press_button(struct sim_net *net, const struct sim_button *button, struct bus_req *req,
                        struct bus_answer *answer)
{
	struct sim_event event = button->event;
	bool on;

	if (bus_write_switch(req, &on))
		return -EINVAL;
	answer->len = bus_write_text(req);
	if (sim_net_lasts(net, &event) == on)
		return 0;
	event.on ^= !on;
	sim_net_apply(net, &event);
	return 0;
}

bool button_answer(struct sim_net *net, struct bus_req *req, int64_t now, struct bus_answer *answer)
{
	const struct sim_button *button;
	struct path path;

	if (!net->buttons || path_split(req->path, strlen(req->path), &path) || path.alarm ||
	    path.bus >= 0 || path.device.len != strlen(DIRECTORY) ||
	    memcmp(path.device.text, DIRECTORY, path.device.len) != 0)
		return false;
	sim_net_run(net, now);
	if (!path.property.len) {
		answer->err = answer_directory(net, req, answer);
		return true;
	}
	button = button_find(net, path.property.text, path.property.len);
	if (!button) {
		answer->err = -ENOENT;
		return true;
	}
	switch ((enum bus_op)req->op) {
	case BUS_READ:
		answer->err = read_state(net, button, req, answer);
		break;
	case BUS_WRITE:
		answer->err = press_button(net, button, req, answer);
		break;
	case BUS_DIR:
		answer->err = -ENOTDIR;
		break;
	case BUS_PROBE:
		break;
	}
	return true;
}
