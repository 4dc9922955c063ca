/* SPDX-License-Identifier: MIT */
/* The raw values of a signal: scaling and filter of what is read, and scaling back of commands. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/state.h"

/* From here on a double's text has not all digits of a whole number. */
#define LARGE_DIGITS INT64_C(1000000000000000)

static bool is_scaled(const struct signal *s)
{
	return scale_changes(&s->item->scale);
}

enum ows_type signal_raw_type(const struct signal *s)
{
	return is_scaled(s) && s->item->type != OWS_BOOL ? OWS_DOUBLE : s->item->type;
}

/* The nearest value of the type; *quality changes only where the type cannot hold the number. */
static int64_t nearest(enum ows_type type, double number, uint8_t *quality)
{
	uint8_t held = OWS_Q_GOOD;
	int64_t value = 0;

	value_from_number(type, value_is_float(type) ? number : round(number), &value, &held);
	if (held != OWS_Q_GOOD)
		*quality = held;
	return value;
}

int signal_scale_raw(struct signal *s, int64_t raw, int64_t measured_ns, uint8_t *quality)
{
	double read = value_number(signal_raw_type(s), raw), number = read;
	bool filtered = s->item->filter_s > 0;

	if (*quality == OWS_Q_GOOD)
		number = scale_value(&s->item->scale, number, quality);
	if (*quality == OWS_Q_GOOD && s->item->max_step > 0 &&
	    !step_passes(&s->scaling.step, s->item->max_step, number, measured_ns))
		return -EREMCHG;
	s->attrs.raw = value_of_double(read);
	s->sample.value = raw;
	/* it begins anew after all that was not good, and with this one if it is not */
	if (*quality != OWS_Q_GOOD || !ows_good(s->sample.quality))
		s->scaling.filter.begun = false;
	if (*quality == OWS_Q_GOOD && filtered)
		number = filter_sample(&s->scaling.filter, s->item->filter_s, number, measured_ns);
	if (is_scaled(s) || filtered)
		s->sample.value = nearest(s->item->type, number, quality);
	return 0;
}

/* --- Commands -------------------------------------------------------------------------------- */

static int raw_of(const struct signal *s, int64_t value, double *raw)
{
	int err = scale_raw(&s->item->scale, value_number(s->item->type, value), raw);

	if (!err && is_scaled(s) && s->item->whole)
		*raw = round(*raw) + 0.0; /* no negative zero */
	return err;
}

bool signal_accepts(const struct signal *s, int64_t value)
{
	double raw;

	return value_holds(s->item->type, value) && raw_of(s, value, &raw) == 0;
}

void signal_write(struct slot *slot, const struct signal *s, int64_t value, const char *text,
                  size_t len)
{
	enum ows_type type = is_scaled(s) ? OWS_DOUBLE : s->item->type;
	struct bus_req *req = &slot->req;
	bool large = type == OWS_LARGE && (value <= -LARGE_DIGITS || value >= LARGE_DIGITS);

	slot->value = value;
	req->op = BUS_WRITE;
	req->number = type != OWS_STRING && !large;
	req->single = type == OWS_FLOAT;
	req->value = value_number(s->item->type, value);
	raw_of(s, value, &req->value);
	req->len = type == OWS_STRING ? (uint32_t)len : 0;
	if (large)
		req->len = (uint32_t)value_to_text(type, value, (char *)slot->data);
	else if (type == OWS_STRING)
		memcpy(slot->data, text, len);
}

void signal_written(struct signal *s, int64_t value)
{
	double raw = value_number(s->item->type, value);

	raw_of(s, value, &raw);
	s->scaling.filter.begun = false;
	step_begin(&s->scaling.step, value_number(s->item->type, value), s->sample.tried_ns);
	s->scaling.written = value_of_double(raw);
	if (s->command.differs)
		return;
	s->attrs.raw = s->scaling.written;
	s->sample.value = value;
}

bool signal_reads_as_written(struct signal *s, uint8_t *quality)
{
	if (!is_scaled(s))
		return s->sample.value == s->command.written;
	if (s->attrs.raw != s->scaling.written)
		return false;
	s->sample.value = s->command.written;
	*quality = OWS_Q_GOOD;
	return true;
}

/* --- Reload ---------------------------------------------------------------------------------- */

static bool is_judged(uint8_t quality)
{
	return quality == OWS_Q_GOOD || quality == OWS_Q_RANGE || quality == OWS_Q_LOW ||
	       quality == OWS_Q_HIGH;
}

void signal_rescale(struct signal *s, const struct signal *was)
{
	uint8_t quality = OWS_Q_GOOD;
	double raw;

	if (s->item->filter_s != was->item->filter_s)
		s->scaling.filter.begun = false;
	if (s->item->max_step != was->item->max_step)
		s->scaling.step = (struct step){0};
	if (scale_same(&s->item->scale, &was->item->scale))
		return;
	s->scaling.filter.begun = false;
	s->scaling.step = (struct step){0};
	/* the value that was read last, as the new scale has it */
	if (s->sample.count) {
		raw = value_number(OWS_DOUBLE, s->attrs.raw);
		s->sample.value = nearest(s->item->type,
		                          scale_value(&s->item->scale, raw, &quality), &quality);
		if (is_judged(s->sample.quality))
			s->sample.quality = quality;
	}
	/* a command stays in force, and may have another raw value now */
	if (raw_of(s, s->command.value, &raw) || value_of_double(raw) != s->scaling.written)
		signal_forget_written(s);
	else if (s->item->output && s->command.confirmed && is_judged(s->sample.quality))
		signal_reads_as_written(s, &s->sample.quality);
}
