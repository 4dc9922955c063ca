/* SPDX-License-Identifier: MIT */
/*
 * owsctl control: a controller whose program speaks to it by standard input, for languages that
 * cannot receive descriptors. One line, one answer.
 */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/kit/command.h"
#include "src/faces/show/names.h"
#include "src/faces/show/text.h"
#include "src/ground/signal/error.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/verbs.h"

#define LINE_MAX 65536 /* the longest text a layout can hold, and a name */
#define TRIES 10       /* naps until owsd counts as gone */
#define QUOTED 60      /* characters of a value or a name in an answer */
#define QUOTED_BYTES (4 * QUOTED + 1)

struct control {
	struct ows *h;
	const char *instance;
	int err;         /* of the line */
	const char *why; /* what is wrong with the line itself; NULL: err says it */
	char own[2 * FACE_REFUSAL + NAMES_MAX]; /* what why may be */
	char line[LINE_MAX + 256];
};

/* The first word of *rest, ended by NUL; *rest is then what follows the blanks after it. */
static char *next_word(char **rest)
{
	char *word = *rest + strspn(*rest, " \t"), *end = word + strcspn(word, " \t");

	*rest = end + strspn(end, " \t");
	*end = '\0';
	return word;
}

static bool parse_uint32(const char *word, uint32_t *number)
{
	int64_t value;
	bool is = *word >= '0' && *word <= '9' && ctl_count(word, 0, UINT32_MAX, &value);

	*number = is ? (uint32_t)value : 0;
	return is;
}

static int control_find(struct control *control, const char *name)
{
	int id = ows_find(control->h, name);
	char clean[QUOTED_BYTES], nearest[NAMES_MAX];
	bool near;

	if (id != -ENOENT)
		return id;
	near = names_nearest(control->h, name, nearest);
	text_clean(name, strlen(name), QUOTED, clean, sizeof(clean));
	snprintf(control->own, sizeof(control->own), "there is no such name: %s%s%s%s", clean,
	         near ? "; did you mean " : "", near ? nearest : "", near ? "?" : "");
	control->why = control->own;
	return id;
}

/* Which values there are. */
static struct ows_info values_of(struct control *control, const char *name)
{
	struct ows_info info = {.min = NAN, .max = NAN};
	enum attribute attribute;
	int signal;

	if (names_lookup(control->h, control->instance, name, &signal, &attribute) != 0)
		return info;
	if (attribute != ATTR_VALUE || ows_info(control->h, signal, &info) != 0)
		info.type = (uint8_t)attribute_table[attribute].type;
	info.name = name;
	return info;
}

static int do_set(struct control *control, char *equals)
{
	struct face_command command = {.program = "owsctl", .text = equals + 1};
	char words[FACE_REFUSAL];
	struct ows_info info;
	int id, err;

	*equals = '\0';
	id = control_find(control, control->line);
	if (id < 0)
		return id;
	err = ows_set_text(control->h, id, equals + 1, NULL);
	if (!err || err == -ESTALE)
		return err;
	info = values_of(control, control->line);
	face_refusal(&command, &info, err, words);
	text_clean(words, strlen(words), FACE_REFUSAL, control->own, sizeof(control->own));
	control->why = control->own;
	return err;
}

static int do_beat(struct control *control, char *rest)
{
	uint32_t period_ms;

	if (!parse_uint32(next_word(&rest), &period_ms) || !period_ms || *rest) {
		control->why = "beat takes a number of milliseconds";
		return -EINVAL;
	}
	if (period_ms > OWS_BEAT_MOST_MS)
		control->why = "the longest beat is 3600000 milliseconds, an hour";
	return ows_beat(control->h, period_ms);
}

static int do_for(struct control *control, char *rest)
{
	return ows_for(control->h, rest);
}

static int do_ack(struct control *control, char *rest)
{
	struct ows_alarm_state state = {0};
	int id = control_find(control, rest);
	int err = id < 0 ? id : ows_alarm_state(control->h, id, &state);

	if (err)
		return err;
	return state.limits ? ows_acknowledge(control->h, id) : -EOPNOTSUPP;
}

static int do_shelve(struct control *control, char *rest)
{
	char *name = next_word(&rest);
	uint32_t seconds;
	int id = control_find(control, name);

	if (id < 0)
		return id;
	if (!parse_uint32(next_word(&rest), &seconds)) {
		control->why = "shelve takes a name, a number of seconds, and why";
		return -EINVAL;
	}
	return ows_shelve(control->h, id, seconds, rest);
}

static const struct {
	const char *word;
	int (*run)(struct control *control, char *rest);
} orders[] = {
	{"beat", do_beat},
	{"for", do_for},
	{"ack", do_ack},
	{"shelve", do_shelve},
};

/* NAME=VALUE, where no blank is before the '='; else an order and what belongs to it. */
static int do_line(struct control *control)
{
	char *line = control->line, *equals = line + strcspn(line, "= \t"), *rest = line, *word;

	control->why = NULL;
	if (*equals == '=')
		return do_set(control, equals);
	word = next_word(&rest);
	for (size_t i = 0; i < sizeof(orders) / sizeof(orders[0]); i++)
		if (strcmp(word, orders[i].word) == 0)
			return orders[i].run(control, rest);
	control->why = "a line is NAME=VALUE (no blanks around =), beat, for, ack, shelve or quit";
	return -EINVAL;
}

/* The same, and again where owsd has just moved to another memory. */
static void run_line(struct control *control, char *copy)
{
	memcpy(copy, control->line, strlen(control->line) + 1);
	control->err = do_line(control);
	for (int i = 0; control->err == -ESTALE && i < TRIES; i++) {
		if (ows_reopen(control->h) != 0)
			ctl_nap();
		memcpy(control->line, copy, strlen(copy) + 1);
		control->err = do_line(control);
	}
}

static bool print_answer(const struct control *control)
{
	const struct face_command command = {.program = "owsctl"};
	const struct ows_info none = {.type = OWS_BOOL};
	char words[FACE_REFUSAL];
	const char *why = control->why;

	if (control->err == -EOPNOTSUPP)
		why = "it has no limit alarms";
	else if (!why && (control->err == -EINVAL || control->err == -ERANGE))
		why = "it is too long or out of range";
	else if (!why)
		why = face_refusal(&command, &none, control->err, words);
	if (control->err)
		printf("error %s\n", why);
	else
		puts("ok");
	return ctl_flush_lines();
}

/*
 * Read a line without its newline. False: the input has ended. Of a line that is too long, or has a
 * NUL, err is set.
 */
static bool read_line(struct control *control)
{
	size_t n = 0;
	int c;

	control->err = 0;
	while ((c = getchar()) != EOF && c != '\n') {
		if (c == '\0')
			control->err = -EINVAL;
		if (n < sizeof(control->line) - 1)
			control->line[n++] = (char)c;
		else
			control->err = -EINVAL;
	}
	if (n > 0 && control->line[n - 1] == '\r')
		n--;
	control->line[n] = '\0';
	control->why = "the line is too long, or has a NUL";
	return c != EOF;
}

/* Returns whether the program said goodbye. */
static bool control_follow(struct control *control, char *copy)
{
	while (read_line(control)) {
		if (!control->err) {
			if (strcmp(control->line, "quit") == 0)
				return true;
			run_line(control, copy);
		}
		if (!print_answer(control))
			break;
	}
	return false;
}

int verb_control(struct ctl *ctl, int argc, char **argv)
{
	/* Static: to the end of the process, see below */
	static struct control control;
	static char copy[sizeof(control.line)];
	const char *name = "owsctl";
	while (ctl_option(ctl, argc, argv, "A:") != -1)
		name = optarg;
	if (optind < argc)
		return ctl_usage(ctl, "control takes its orders from standard input");
	control.instance = ctl->instance;
	control.h = ctl_open_as(ctl, OWS_CONTROL, name);
	if (!control_follow(&control, copy))
		return CTL_DONE; /* Not closed: owsd takes the end for a loss, not for a goodbye */
	ows_close(control.h);
	puts("ok");
	return CTL_DONE;
}
