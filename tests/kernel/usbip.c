/* SPDX-License-Identifier: MIT */
/* The headers of USB/IP: decoded and encoded. */
#include <errno.h>
#include <string.h>

#include "tests/kernel/usbip.h"

enum {
	AT_COMMAND = 0,
	AT_SEQ = 4,
	AT_DIRECTION = 12,
	AT_ENDPOINT = 16,
	AT_STATUS = 20,
	AT_UNLINKED = 20,
	AT_LENGTH = 24,
	AT_SETUP = 40,
};

static uint32_t get32(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void put32(uint8_t *p, uint32_t value)
{
	p[0] = (uint8_t)(value >> 24);
	p[1] = (uint8_t)(value >> 16);
	p[2] = (uint8_t)(value >> 8);
	p[3] = (uint8_t)value;
}

int usbip_decode(const uint8_t header[USBIP_HEADER], struct usbip_request *request)
{
	uint32_t command = get32(header + AT_COMMAND);

	memset(request, 0, sizeof(*request));
	if (command != USBIP_CMD_SUBMIT && command != USBIP_CMD_UNLINK)
		return -EPROTO;
	request->command = (enum usbip_command)command;
	request->seq = get32(header + AT_SEQ);
	if (command == USBIP_CMD_UNLINK) {
		request->unlinked = get32(header + AT_UNLINKED);
		return 0;
	}
	request->in = get32(header + AT_DIRECTION) == 1;
	request->endpoint = get32(header + AT_ENDPOINT);
	request->length = get32(header + AT_LENGTH);
	memcpy(request->setup, header + AT_SETUP, sizeof(request->setup));
	if (request->endpoint > 15 || request->length > USBIP_MAX_DATA)
		return -EPROTO;
	return 0;
}

void usbip_answer(uint8_t header[USBIP_HEADER], const struct usbip_request *request, int32_t status,
                  uint32_t actual)
{
	bool unlink = request->command == USBIP_CMD_UNLINK;

	memset(header, 0, USBIP_HEADER);
	put32(header + AT_COMMAND, unlink ? USBIP_RET_UNLINK : USBIP_RET_SUBMIT);
	put32(header + AT_SEQ, request->seq);
	put32(header + AT_STATUS, (uint32_t)status);
	if (!unlink)
		put32(header + AT_LENGTH, actual);
}
