/* SPDX-License-Identifier: MIT */
/* Reads requests and writes answers, as MODBUS Application Protocol V1.1b3 has them. */
#include <errno.h>
#include <string.h>

#include "src/faces/modbus/answer.h"

#define REGISTERS_MOST 125
#define BITS_MOST 2000
#define WRITTEN_MOST 123
/* Inputs of one bit: the value is not 0; from these on, it is good, it has an alarm */
#define BITS_GOOD 10000
#define BITS_ALARM 20000

enum function {
	READ_COILS = 1,
	READ_INPUTS = 2,
	READ_HOLDING = 3,
	READ_REGISTERS = 4,
	WRITE_COIL = 5,
	WRITE_REGISTER = 6,
	WRITE_COILS = 15,
	WRITE_REGISTERS = 16,
};

/* A request without its head, and its answer. */
struct exchange {
	const struct answer_source *source;
	const uint8_t *request;
	size_t n;
	uint8_t *answer;
	size_t len;
	/* of the place that was looked at last; 0: none */
	unsigned place;
	struct layout_row row;
	bool has, has_header;
	uint16_t header[LAYOUT_RECORD];
};

static unsigned word_at(const uint8_t *bytes)
{
	return (unsigned)bytes[0] << 8 | bytes[1];
}

static void put_word(uint8_t *bytes, unsigned word)
{
	bytes[0] = (uint8_t)(word >> 8);
	bytes[1] = (uint8_t)word;
}

int frame_length(const uint8_t *bytes, size_t n)
{
	unsigned length;

	if (n >= 4 && word_at(bytes + 2) != 0)
		return -EBADMSG;
	if (n < 6)
		return 0;
	length = word_at(bytes + 4);
	if (length < 2 || length > 1 + FRAME_PDU_MOST)
		return -EBADMSG;
	return n < 6 + length ? 0 : (int)(6 + length);
}

static enum exception look_at(struct exchange *x, unsigned place)
{
	enum exception wrong;

	if (place && place == x->place)
		return EXCEPTION_NONE;
	x->place = 0;
	if (!place || place >= LAYOUT_PLACES)
		return EXCEPTION_ADDRESS;
	wrong = x->source->row(x->source->ctx, place, &x->row, &x->has);
	if (!wrong)
		x->place = place;
	return wrong;
}

static enum exception read_register(struct exchange *x, unsigned address, uint16_t *word)
{
	struct layout_place at;
	enum exception wrong;

	if (!layout_find(address, &at))
		return EXCEPTION_ADDRESS;
	if (at.field == LAYOUT_HEADER) {
		if (!x->has_header)
			x->source->header(x->source->ctx, x->header);
		x->has_header = true;
		*word = x->header[at.part];
		return EXCEPTION_NONE;
	}
	wrong = look_at(x, at.place);
	if (wrong)
		return wrong;
	if (x->source->exceptions && !x->row.good && layout_is_value(at.field))
		return EXCEPTION_NO_TARGET;
	*word = layout_register(&x->row, &at, x->source->little);
	return EXCEPTION_NONE;
}

static enum exception read_registers(struct exchange *x)
{
	unsigned first = word_at(x->request + 1), count = word_at(x->request + 3);
	enum exception wrong = EXCEPTION_NONE;
	uint16_t word = 0;

	if (count < 1 || count > REGISTERS_MOST)
		return EXCEPTION_VALUE;
	x->answer[1] = (uint8_t)(2 * count);
	for (unsigned i = 0; i < count && !wrong; i++) {
		wrong = read_register(x, first + i, &word);
		put_word(x->answer + 2 + 2 * i, word);
	}
	x->len = 2 + 2 * count;
	return wrong;
}

/* There is no bit that is not one, so one of a value that is not good cannot be had. */
static enum exception read_bit(struct exchange *x, unsigned address, bool *bit)
{
	unsigned from = x->request[0] == READ_COILS ? 0
	                : address >= BITS_ALARM     ? BITS_ALARM
	                : address >= BITS_GOOD      ? BITS_GOOD
	                                            : 0;
	enum exception wrong = look_at(x, address - from);

	if (wrong)
		return wrong;
	if (!x->has)
		return EXCEPTION_ADDRESS;
	if (from == 0 && !x->row.good)
		return EXCEPTION_NO_TARGET;
	*bit = from == BITS_ALARM  ? x->row.alarm & (LAYOUT_ALARM_LIMIT | LAYOUT_ALARM_DEVICE)
	       : from == BITS_GOOD ? x->row.good
	                           : x->row.number != 0;
	return EXCEPTION_NONE;
}

static enum exception read_bits(struct exchange *x)
{
	unsigned first = word_at(x->request + 1), count = word_at(x->request + 3);
	enum exception wrong = EXCEPTION_NONE;
	bool bit = false;

	if (count < 1 || count > BITS_MOST)
		return EXCEPTION_VALUE;
	x->answer[1] = (uint8_t)((count + 7) / 8);
	memset(x->answer + 2, 0, x->answer[1]);
	for (unsigned i = 0; i < count && !wrong; i++) {
		wrong = read_bit(x, first + i, &bit);
		if (!wrong && bit)
			x->answer[2 + i / 8] |= (uint8_t)(1u << i % 8);
	}
	x->len = 2u + x->answer[1];
	return wrong;
}

/* Write registers of which the first stands at data: the values that they are. */
static enum exception write_values(struct exchange *x, const uint8_t *data, unsigned count)
{
	const struct answer_source *source = x->source;
	unsigned first = word_at(x->request + 1), width;
	enum exception wrong = EXCEPTION_NONE;
	uint16_t words[LAYOUT_FIELD_MOST];
	struct layout_place at;
	double number;

	for (unsigned i = 0; i < count && !wrong; i += width) {
		if (!layout_find(first + i, &at))
			return EXCEPTION_ADDRESS;
		width = layout_width(at.field);
		if (at.field == LAYOUT_HEADER && at.part == LAYOUT_BEAT) {
			wrong = source->beat(source->ctx);
			continue;
		}
		if (!layout_is_value(at.field) || at.part)
			return EXCEPTION_ADDRESS;
		wrong = look_at(x, at.place);
		if (wrong)
			return wrong;
		/* the rest of the number may be in a request that never comes */
		if (i + width > count)
			return EXCEPTION_VALUE;
		for (unsigned k = 0; k < width; k++)
			words[k] = (uint16_t)word_at(data + 2 * (i + k));
		if (!layout_number(words, at.field, x->row.decimals, source->little, &number))
			return EXCEPTION_VALUE;
		wrong = source->write(source->ctx, at.place, number);
	}
	return wrong;
}

static enum exception write_bits(struct exchange *x, const uint8_t *bits, unsigned count)
{
	enum exception wrong = EXCEPTION_NONE;

	for (unsigned i = 0; i < count && !wrong; i++) {
		unsigned place = word_at(x->request + 1) + i;

		wrong = look_at(x, place);
		if (!wrong)
			wrong = x->source->write(x->source->ctx, place, bits[i / 8] >> i % 8 & 1);
	}
	return wrong;
}

static enum exception commit(struct exchange *x, enum exception wrong)
{
	memcpy(x->answer + 1, x->request + 1, 4);
	x->len = 5;
	return wrong ? wrong : x->source->commit(x->source->ctx);
}

static enum exception write_coil(struct exchange *x)
{
	unsigned value = word_at(x->request + 3);
	uint8_t bit = value != 0;

	if (value != 0 && value != 0xff00)
		return EXCEPTION_VALUE;
	return commit(x, write_bits(x, &bit, 1));
}

static enum exception write_register(struct exchange *x)
{
	return commit(x, write_values(x, x->request + 3, 1));
}

static enum exception write_coils(struct exchange *x)
{
	unsigned count = word_at(x->request + 3);

	if (count < 1 || count > FRAME_WRITES_MOST || x->request[5] != (count + 7) / 8 ||
	    x->n != 6u + x->request[5])
		return EXCEPTION_VALUE;
	return commit(x, write_bits(x, x->request + 6, count));
}

static enum exception write_registers(struct exchange *x)
{
	unsigned count = word_at(x->request + 3);

	if (count < 1 || count > WRITTEN_MOST || x->request[5] != 2 * count ||
	    x->n != 6 + 2 * count)
		return EXCEPTION_VALUE;
	return commit(x, write_values(x, x->request + 6, count));
}

/* Which functions there are, and how long their requests are: so long, or at least so long. */
static const struct {
	enum function function;
	size_t length;
	bool more;
	enum exception (*answer)(struct exchange *x);
} functions[] = {
	{READ_COILS, 5, false, read_bits},        {READ_INPUTS, 5, false, read_bits},
	{READ_HOLDING, 5, false, read_registers}, {READ_REGISTERS, 5, false, read_registers},
	{WRITE_COIL, 5, false, write_coil},       {WRITE_REGISTER, 5, false, write_register},
	{WRITE_COILS, 6, true, write_coils},      {WRITE_REGISTERS, 6, true, write_registers},
};

static enum exception answer_pdu(struct exchange *x)
{
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		if (functions[i].function != x->request[0])
			continue;
		if (x->n < functions[i].length ||
		    (!functions[i].more && x->n != functions[i].length))
			return EXCEPTION_VALUE;
		return functions[i].answer(x);
	}
	return EXCEPTION_FUNCTION;
}

bool frame_refused(const uint8_t *request, const uint8_t *answer)
{
	return request[FRAME_HEAD] > READ_REGISTERS && answer[FRAME_HEAD] & 0x80;
}

size_t frame_answer(const struct answer_source *source, const uint8_t *request,
                    uint8_t answer[FRAME_MOST])
{
	struct exchange x = {.source = source,
	                     .request = request + FRAME_HEAD,
	                     .n = word_at(request + 4) - 1,
	                     .answer = answer + FRAME_HEAD};
	enum exception wrong;

	/* on a line another unit would answer; here the client would wait for nothing */
	if (source->unit && request[6] != source->unit)
		wrong = EXCEPTION_NO_TARGET;
	else
		wrong = answer_pdu(&x);
	x.answer[0] = x.request[0];
	if (wrong) {
		x.answer[0] |= 0x80;
		x.answer[1] = (uint8_t)wrong;
		x.len = 2;
	}
	memcpy(answer, request, FRAME_HEAD);
	put_word(answer + 4, (unsigned)x.len + 1);
	return FRAME_HEAD + x.len;
}
