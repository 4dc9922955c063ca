/* SPDX-License-Identifier: MIT */
/*
 * history DIR: all that the directory's history has, by libows-history, for tests: a line for each
 * item of each signal, "NAME TIME VALUE QUALITY" or "NAME TIME - REASON", and for each event, "!
 * KIND TIME ...". TIME is boot time in seconds; QUALITY has two hexadecimal digits.
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "src/ground/signal/value.h"
#include "src/public/ows_history.h"

static double seconds(int64_t ns)
{
	return (double)ns / 1e9;
}

static int64_t bits(uint8_t type, double number, int64_t integer)
{
	return value_is_float((enum ows_type)type) ? value_of_double(number) : integer;
}

static void print_item(const char *name, const struct ows_history_item *item)
{
	char text[VALUE_TEXT_MAX];

	printf("%s %.6f ", name, seconds(item->boot_ns));
	if (!item->known) {
		printf("- %s\n", ows_history_reason_text(item->reason));
		return;
	}
	if (item->type == OWS_STRING) {
		printf("\"%.*s\" %02x\n", (int)item->len, item->text, item->quality);
		return;
	}
	value_to_text((enum ows_type)item->type, bits(item->type, item->number, item->integer),
	              text);
	printf("%s %02x\n", text, item->quality);
}

static void print_event(struct ows_history *h, const struct ows_history_event *e)
{
	struct ows_history_signal known = {.name = "-"};
	char text[VALUE_TEXT_MAX] = "-";

	if (e->signal >= 0)
		ows_history_signal(h, e->signal, &known);
	switch ((enum ows_history_kind)e->kind) {
	case OWS_HISTORY_BEGIN:
		printf("! begin %.6f\n", seconds(e->boot_ns));
		break;
	case OWS_HISTORY_END:
		printf("! end %.6f\n", seconds(e->boot_ns));
		break;
	case OWS_HISTORY_GAP:
		printf("! gap %.6f %.6f %s\n", seconds(e->boot_ns),
		       seconds(e->boot_ns + e->until_ns - e->time_ns),
		       ows_history_reason_text(e->reason));
		break;
	case OWS_HISTORY_CLOCK:
		printf("! clock %.6f\n", seconds(e->boot_ns));
		break;
	case OWS_HISTORY_COMMAND:
	case OWS_HISTORY_ALARM:
		if (e->type != OWS_STRING)
			value_to_text((enum ows_type)e->type, bits(e->type, e->number, e->integer),
			              text);
		printf("! %s %.6f %s %s %u %u by %s\n",
		       e->kind == OWS_HISTORY_ALARM ? "alarm" : "command", seconds(e->boot_ns),
		       known.name, text, e->reason, e->event, e->who.serial ? e->who.name : "-");
		break;
	}
}

int main(int argc, char **argv)
{
	struct ows_history_event event;
	struct ows_history_item item;
	struct ows_history *h;
	int err;

	if (argc != 2)
		return 2;
	err = ows_history_open(NULL, argv[1], &h);
	if (err) {
		fprintf(stderr, "%s: %s\n", argv[1], strerror(-err));
		return 1;
	}
	for (int i = 0; !err && i < ows_history_signals(h); i++) {
		struct ows_history_signal known;

		ows_history_signal(h, i, &known);
		err = ows_history_read(h, i, 0, INT64_MAX);
		while (!err && (err = ows_history_next(h, &item, 1)) == 1) {
			print_item(known.name, &item);
			err = 0;
		}
	}
	if (!err)
		err = ows_history_events(h, 0, INT64_MAX, 0);
	while (!err && (err = ows_history_next_event(h, &event)) == 1) {
		print_event(h, &event);
		err = 0;
	}
	if (err)
		fprintf(stderr, "%s: %s\n", argv[1], strerror(-err));
	ows_history_close(h);
	return err != 0;
}
