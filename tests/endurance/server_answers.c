/* SPDX-License-Identifier: MIT */
/* What an owserver knows of the field, and what it answers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/endurance/server.h"

static bool has(const struct part *part, int device)
{
	return device >= 0 && !field.device[device].away && field.device[device].wire == part->wire;
}

static int number(char *text, size_t size, unsigned value)
{
	return snprintf(text, size, "%12u", value);
}

static int switch_property(struct server *s, const char *property, char *text, size_t size)
{
	if (strcmp(property, "sensed.BYTE") == 0)
		return number(text, size, field_pins() << 4 | (~s->relays & 0xf));
	if (strcmp(property, "PIO.BYTE") == 0)
		return number(text, size, s->relays);
	if (strcmp(property, "latch.BYTE") == 0)
		return number(text, size, s->latch);
	if (strcmp(property, "por") == 0)
		return number(text, size, s->por);
	if (strcmp(property, "set_alarm") == 0)
		return number(text, size, s->set_alarm);
	return -1;
}

/* Length of the text, or a code of the protocol. */
static int read_property(struct part *part, const char *path, char *text, size_t size)
{
	struct server *s = server_of(part);
	int device;
	const char *property;

	if (strncmp(path, "/bus.0/interface/settings/name", 30) == 0)
		return snprintf(text, size, "DS9490R");
	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	device = field_find(path + 1);
	property = device < 0 ? NULL : strchr(path + 1, '/');
	if (!property)
		return -1;
	if (!has(part, device))
		return -1;
	property++;
	if (strcmp(property, "type") == 0)
		return snprintf(text, size, field.device[device].is_switch ? "DS2408" : "DS18B20");
	if (field.device[device].is_switch)
		return switch_property(s, property, text, size);
	if (strcmp(property, "temperature12") != 0)
		return -1;
	if (s->lie == FAULT_85 && device != 1) /* near 85 it could be true */
		return snprintf(text, size, "          85");
	if (s->lie == FAULT_127)
		return snprintf(text, size, "     127.938");
	return snprintf(text, size, "%12g", field_temperature((unsigned)device, world_now()));
}

static int write_property(struct part *part, const char *path, const char *data)
{
	struct server *s = server_of(part);
	int device;
	const char *property;

	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	device = field_find(path + 1);
	property = device < 0 ? NULL : strchr(path + 1, '/');
	if (!property || !has(part, device) || !field.device[device].is_switch)
		return -1;
	property++;
	if (strcmp(property, "PIO.BYTE") == 0)
		s->relays = (unsigned)strtoul(data, NULL, 10) & 0xf;
	else if (strcmp(property, "latch.BYTE") == 0)
		s->latch = 0;
	else if (strcmp(property, "por") == 0)
		s->por = false;
	else if (strcmp(property, "set_alarm") == 0)
		s->set_alarm = (unsigned)strtoul(data, NULL, 10);
	else
		return -1;
	return 0;
}

static int list(struct part *part, const char *path, char *text, size_t size)
{
	struct server *s = server_of(part);
	bool alarm = strncmp(path, "/alarm", 6) == 0;
	size_t n = 0;

	text[0] = '\0';
	for (unsigned i = 0; i < field.devices; i++) {
		bool in = field.device[i].is_switch && (s->por || (s->latch && s->set_alarm));

		if (has(part, (int)i) && (!alarm || in))
			n += (size_t)snprintf(text + n, size - n, "%s%s/%s", n ? "," : "",
			                      alarm ? "/alarm" : "", field.device[i].id);
	}
	return (int)n;
}

/* The text of an answer, or its code. */
int server_answer(struct part *part, const struct frame_header *request, const char *path,
                  const char *data, char *text, size_t size)
{
	enum lie lie = server_of(part)->lie;

	switch ((enum frame_type)request->type) {
	case FRAME_READ:
		if (lie == ERRORS && strncmp(path, "/bus.", 5) != 0)
			return -5;
		if (lie == NO_DEVICE && strncmp(path, "/bus.", 5) != 0)
			return -1;
		if (lie == NO_NUMBER && strstr(path, "temperature"))
			return snprintf(text, size, "fifteen");
		if (lie == EMPTY && strstr(path, "temperature"))
			return 0;
		return read_property(part, path, text, size);
	case FRAME_WRITE:
		return lie == ERRORS ? -5 : write_property(part, path, data);
	case FRAME_PRESENT:
		return has(part, field_find(path + 1)) && lie != NO_DEVICE ? 0 : -1;
	case FRAME_DIRALL:
		return list(part, path, text, size);
	case FRAME_NOP:
	case FRAME_DIR:
	case FRAME_GET:
	case FRAME_DIRALLSLASH:
	case FRAME_GETSLASH:
		break;
	}
	return 0;
}
