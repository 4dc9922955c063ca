/* SPDX-License-Identifier: MIT */
/* Tests of the queue behind USB/IP: what a device does not answer waits, and can be taken back. */
#include <errno.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "tests/kernel/vhci.h"

enum { ROOM = 16 };

static struct vhci vhci;
static int kernel;    /* the kernel's end */
static int answer_in; /* of transfers in: what the device says */
static uint32_t takes;
static unsigned asked;

static int transfer(void *ctx, const struct usbip_request *request, uint8_t *data, uint32_t moved)
{
	TEST_ASSERT_EQUAL_PTR(&vhci, ctx);
	asked++;
	if (!request->in) {
		uint32_t rest = request->length - moved;

		TEST_ASSERT_EQUAL_HEX8(0x40, data[moved]);
		return takes ? (int)(rest < takes ? rest : takes) : -EAGAIN;
	}
	if (answer_in > 0)
		memset(data, 0x5A, (size_t)answer_in);
	return answer_in;
}

void setUp(void)
{
	int ends[2];

	TEST_ASSERT_EQUAL_INT(0, socketpair(AF_UNIX, SOCK_STREAM, 0, ends));
	kernel = ends[1];
	vhci = (struct vhci){.fd = ends[0], .transfer = transfer, .ctx = &vhci};
	answer_in = -EAGAIN;
	takes = 0;
	asked = 0;
}

void tearDown(void)
{
	if (vhci.fd >= 0)
		vhci_unplug(&vhci);
	close(kernel);
}

static void submit(uint8_t seq, bool in, uint8_t endpoint, uint8_t len)
{
	uint8_t header[USBIP_HEADER + ROOM] = {
		[3] = USBIP_CMD_SUBMIT, [7] = seq, [15] = in, [19] = endpoint, [27] = len};
	size_t size = USBIP_HEADER + (in ? 0u : len);

	memset(header + USBIP_HEADER, 0x40, ROOM);
	TEST_ASSERT_EQUAL_INT((int)size, write(kernel, header, size));
	TEST_ASSERT_EQUAL_INT(0, vhci_serve(&vhci));
}

struct answer {
	uint8_t command, seq; /* seq 0: none has come */
	int8_t status;
	uint8_t len;
};

static struct answer take(void)
{
	uint8_t header[USBIP_HEADER] = {0}, data[ROOM] = {0};
	struct answer answer;

	recv(kernel, header, sizeof(header), MSG_DONTWAIT);
	answer = (struct answer){header[3], header[7], (int8_t)header[23], header[27]};
	if (answer_in > 0 && answer.len) {
		TEST_ASSERT_EQUAL_INT(answer.len, recv(kernel, data, answer.len, MSG_DONTWAIT));
		TEST_ASSERT_EQUAL_HEX8(0x5A, data[answer.len - 1]);
	}
	return answer;
}

static void check(uint8_t command, uint8_t seq, int status, uint8_t len)
{
	struct answer answer = take();

	TEST_ASSERT_EQUAL_UINT8(seq, answer.seq);
	TEST_ASSERT_EQUAL_UINT8(command, answer.command);
	TEST_ASSERT_EQUAL_INT(status, answer.status);
	TEST_ASSERT_EQUAL_UINT8(len, answer.len);
}

static void test_what_the_device_has_is_answered_at_once(void)
{
	answer_in = 9;
	submit(1, true, 3, ROOM);
	check(USBIP_RET_SUBMIT, 1, 0, 9);
	answer_in = -EPIPE;
	submit(2, true, 3, ROOM);
	check(USBIP_RET_SUBMIT, 2, -EPIPE, 0);
	TEST_ASSERT_FALSE(vhci_waits(&vhci, 3));
}

static void test_a_nak_waits_and_others_go_past(void)
{
	submit(1, true, 3, ROOM);
	TEST_ASSERT_TRUE(vhci_waits(&vhci, 3));
	TEST_ASSERT_FALSE(vhci_waits(&vhci, 1));
	takes = ROOM;
	submit(2, false, 2, 4);
	check(USBIP_RET_SUBMIT, 2, 0, 4);
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	TEST_ASSERT_EQUAL_UINT8(0, take().seq);
	answer_in = 2;
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	check(USBIP_RET_SUBMIT, 1, 0, 2);
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	TEST_ASSERT_EQUAL_UINT(4, asked);
}

static void test_bytes_out_are_taken_in_pieces(void)
{
	takes = 4;
	submit(1, false, 2, 10);
	TEST_ASSERT_EQUAL_UINT8(0, take().seq);
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	TEST_ASSERT_EQUAL_UINT8(0, take().seq);
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	check(USBIP_RET_SUBMIT, 1, 0, 10);
}

static void test_what_waits_can_be_taken_back(void)
{
	const uint8_t unlink[USBIP_HEADER] = {[3] = USBIP_CMD_UNLINK, [7] = 9, [23] = 1};

	submit(1, true, 3, ROOM);
	submit(2, true, 1, ROOM);
	TEST_ASSERT_EQUAL_INT(USBIP_HEADER, write(kernel, unlink, sizeof(unlink)));
	TEST_ASSERT_EQUAL_INT(0, vhci_serve(&vhci));
	check(USBIP_RET_UNLINK, 9, -ECONNRESET, 0);
	answer_in = 1;
	TEST_ASSERT_EQUAL_INT(0, vhci_again(&vhci));
	check(USBIP_RET_SUBMIT, 2, 0, 1);
	TEST_ASSERT_EQUAL_INT(USBIP_HEADER, write(kernel, unlink, sizeof(unlink)));
	TEST_ASSERT_EQUAL_INT(0, vhci_serve(&vhci));
	check(USBIP_RET_UNLINK, 9, 0, 0); /* too late */
}

static void test_no_more_wait_than_there_is_room_for(void)
{
	uint8_t header[USBIP_HEADER] = {[3] = USBIP_CMD_SUBMIT, [15] = 1, [19] = 3, [27] = 1};

	for (uint8_t i = 1; i <= VHCI_WAITING; i++)
		submit(i, true, 3, ROOM);
	TEST_ASSERT_EQUAL_INT(USBIP_HEADER, write(kernel, header, sizeof(header)));
	TEST_ASSERT_EQUAL_INT(-ENOBUFS, vhci_serve(&vhci));
}

static void test_a_kernel_that_lets_go_is_told(void)
{
	close(kernel);
	kernel = -1;
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, vhci_serve(&vhci));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_the_device_has_is_answered_at_once);
	RUN_TEST(test_a_nak_waits_and_others_go_past);
	RUN_TEST(test_bytes_out_are_taken_in_pieces);
	RUN_TEST(test_what_waits_can_be_taken_back);
	RUN_TEST(test_no_more_wait_than_there_is_room_for);
	RUN_TEST(test_a_kernel_that_lets_go_is_told);
	return UNITY_END();
}
