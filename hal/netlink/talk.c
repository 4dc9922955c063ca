/* SPDX-License-Identifier: MIT */
/*
 * One request is one datagram: the headers of netlink, connector and w1, then the commands. The
 * kernel replies with a status for each command and, before it, with what READ, TOUCH and SEARCH
 * have read; bundled in as few datagrams as it can, or spread over several. All numbers are the
 * machine's own byte order.
 */
#include <errno.h>
#include <linux/connector.h>
#include <linux/netlink.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/native/limits.h"
#include "hal/netlink/talk.h"
#include "hal/wire/crc.h"

/* The kernel's own search goes first, and lasts seconds on a full wire; so does ours. */
#define REPLY_NS (15 * NS_PER_S)
#define SEARCH_NS (60 * NS_PER_S)
#define LOOK_NS NS_PER_S
#define LIST_NS (2 * NS_PER_S)

#define LIST_MASTERS 6
#define MASTER_COMMAND 4
#define BUNDLE 1 /* cn_msg.flags */

struct w1_head {
	uint8_t type, status;
	uint16_t len; /* of what follows */
	uint32_t master, reserved;
};

struct w1_command_head {
	uint8_t code, reserved;
	uint16_t len;
};

#define HEADS (NLMSG_HDRLEN + sizeof(struct cn_msg) + sizeof(struct w1_head))

static int open_socket(void)
{
	struct sockaddr_nl address = {.nl_family = AF_NETLINK};
	int fd = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC, NETLINK_CONNECTOR);

	if (fd < 0)
		return -errno;
	if (bind(fd, (struct sockaddr *)&address, sizeof(address)) == 0)
		return fd;
	int err = -errno;
	close(fd);
	return err;
}

int (*w1_socket)(void) = open_socket;

int w1_talk_open(struct w1_talk *talk)
{
	talk->fd = w1_socket();
	return talk->fd < 0 ? talk->fd : 0;
}

void w1_talk_close(struct w1_talk *talk)
{
	if (talk->fd >= 0)
		close(talk->fd);
	talk->fd = -1;
}

void w1_request_begin(struct w1_request *request, uint32_t master)
{
	request->master = master;
	request->n = HEADS;
	request->count = 0;
	request->found = NULL;
}

int w1_request_add(struct w1_request *request, enum w1_code code, const uint8_t *data, size_t n,
                   uint8_t *in)
{
	struct w1_command_head head = {.code = (uint8_t)code, .len = (uint16_t)n};
	uint8_t *at = request->bytes + request->n;

	if (request->count == W1_COMMANDS || n > sizeof(request->bytes) - request->n - sizeof(head))
		return -EMSGSIZE;
	memcpy(at, &head, sizeof(head));
	if (data)
		memcpy(at + sizeof(head), data, n);
	else
		memset(at + sizeof(head), 0, n);
	request->n += sizeof(head) + n;
	request->command[request->count].code = (uint8_t)code;
	request->command[request->count].size = (uint16_t)n;
	request->command[request->count++].in = in;
	return 0;
}

static int send_request(struct w1_talk *talk, struct w1_request *request, uint8_t type)
{
	uint8_t *bytes = request->bytes;
	struct nlmsghdr netlink = {.nlmsg_len = (uint32_t)request->n,
	                           .nlmsg_type = NLMSG_DONE,
	                           .nlmsg_seq = ++talk->seq};
	struct cn_msg connector = {.id = {CN_W1_IDX, CN_W1_VAL},
	                           .seq = talk->seq,
	                           .len = (uint16_t)(request->n - HEADS + sizeof(struct w1_head)),
	                           .flags = type == MASTER_COMMAND ? BUNDLE : 0};
	struct w1_head head = {
		.type = type, .len = (uint16_t)(request->n - HEADS), .master = request->master};

	memcpy(bytes, &netlink, sizeof(netlink));
	memcpy(bytes + NLMSG_HDRLEN, &connector, sizeof(connector));
	memcpy(bytes + NLMSG_HDRLEN + sizeof(connector), &head, sizeof(head));
	talk->syscalls++;
	return send(talk->fd, bytes, request->n, MSG_NOSIGNAL | MSG_DONTWAIT) < 0 ? -errno : 0;
}

/* The next datagram of the kernel's: its bytes, or an error as w1_request_run. */
static int receive_datagram(struct w1_talk *talk, int64_t until)
{
	const struct bus_env *env = talk->env;
	struct sockaddr_nl from = {.nl_pid = 0};
	socklen_t size = sizeof(from);

	for (;;) {
		int ready = env->wait(env->ctx, talk->fd, POLLIN, until);

		if (ready <= 0)
			return ready < 0 ? ready : -ETIMEDOUT;
		talk->syscalls += 2;
		ssize_t n = recvfrom(talk->fd, talk->in, sizeof(talk->in), MSG_DONTWAIT | MSG_TRUNC,
		                     (struct sockaddr *)&from, &size);
		if (n < 0 && (errno == EAGAIN || errno == EINTR))
			continue;
		if (n <= 0)
			return -EIO;
		if (size == sizeof(from) && from.nl_pid != 0)
			continue;
		return n > (ssize_t)sizeof(talk->in) ? -EPROTO : (int)n;
	}
}

/* How far the replies to a request have come. */
struct progress {
	struct w1_request *request;
	unsigned statuses; /* commands that are over */
};

static int take_found(const struct w1_request *request, const uint8_t *data, size_t n)
{
	for (; n >= 8; data += 8, n -= 8) {
		int err = onewire_rom_valid(data) ? request->found(request->ctx, data) : 0;

		if (err)
			return err;
	}
	return 0;
}

static int take_command_reply(struct progress *progress, const struct w1_head *head,
                              const struct w1_command_head *command, const uint8_t *data,
                              bool is_status)
{
	struct w1_request *request = progress->request;
	unsigned i = progress->statuses;

	if (i == request->count || command->code != request->command[i].code)
		return -EPROTO;
	if (is_status) {
		request->command[i].status = head->status;
		progress->statuses++;
		return 0;
	}
	if (command->code == W1_SEARCH)
		return request->found ? take_found(request, data, command->len) : -EPROTO;
	if (!request->command[i].in || command->len != request->command[i].size)
		return -EPROTO;
	memcpy(request->command[i].in, data, command->len);
	return 0;
}

static int error_of_status(const struct w1_head *head)
{
	return head->status == ENODEV ? -ENODEV : head->status == ENOMEM ? -EIO : -EPROTO;
}

typedef int take(void *ctx, const struct w1_head *head, const uint8_t *data, bool is_status);

/* One w1 message; a status alone is about the whole request. */
static int take_message(void *ctx, const struct w1_head *head, const uint8_t *data, bool is_status)
{
	struct progress *progress = ctx;
	size_t n = head->len;
	int err = 0;

	if (head->type != MASTER_COMMAND || head->master != progress->request->master)
		return -EPROTO;
	if (n == 0)
		return error_of_status(head);
	while (n && !err) {
		struct w1_command_head command;

		if (n < sizeof(command))
			return -EPROTO;
		memcpy(&command, data, sizeof(command));
		if (command.len > n - sizeof(command))
			return -EPROTO;
		err = take_command_reply(progress, head, &command, data + sizeof(command),
		                         is_status);
		data += sizeof(command) + command.len;
		n -= sizeof(command) + command.len;
	}
	return err;
}

static int walk_messages(const uint8_t *data, size_t n, bool is_status, take *one, void *ctx)
{
	int err = 0;

	while (n && !err) {
		struct w1_head head;

		if (n < sizeof(head))
			return -EPROTO;
		memcpy(&head, data, sizeof(head));
		if (head.len > n - sizeof(head))
			return -EPROTO;
		err = one(ctx, &head, data + sizeof(head), is_status);
		data += sizeof(head) + head.len;
		n -= sizeof(head) + head.len;
	}
	return err;
}

/* All w1 messages of a datagram that are about the request sent last; 1: there was one. */
static int walk_datagram(const struct w1_talk *talk, size_t n, take *one, void *ctx)
{
	const uint8_t *data = talk->in + NLMSG_HDRLEN;
	struct nlmsghdr netlink;
	int ours = 0;

	if (n < NLMSG_HDRLEN)
		return -EPROTO;
	memcpy(&netlink, talk->in, sizeof(netlink));
	if (netlink.nlmsg_len < NLMSG_HDRLEN || netlink.nlmsg_len > n)
		return -EPROTO;
	n = netlink.nlmsg_len - NLMSG_HDRLEN;
	while (n >= sizeof(struct cn_msg)) {
		struct cn_msg connector;

		memcpy(&connector, data, sizeof(connector));
		data += sizeof(connector);
		n -= sizeof(connector);
		if (connector.len > n)
			return -EPROTO;
		if (connector.id.idx == CN_W1_IDX && connector.seq == talk->seq) {
			int err = walk_messages(data, connector.len, connector.ack != talk->seq + 1,
			                        one, ctx);

			if (err)
				return err;
			ours = 1;
		}
		data += connector.len;
		n -= connector.len;
	}
	return ours;
}

/* The next datagram, as long as the master is there. */
static int receive_reply(struct w1_talk *talk, uint32_t master, int64_t until)
{
	int n;

	do {
		int64_t look = bus_now(talk->env) + LOOK_NS;

		n = receive_datagram(talk, look < until ? look : until);
		if (n == -ETIMEDOUT && !talk->has_master(talk->ctx, master))
			return -ENODEV;
	} while (n == -ETIMEDOUT && bus_now(talk->env) < until);
	return n;
}

int w1_request_run(struct w1_talk *talk, struct w1_request *request)
{
	struct progress progress = {.request = request};
	bool search = request->count && request->command[0].code == W1_SEARCH;
	int64_t until = bus_now(talk->env) + (search ? SEARCH_NS : REPLY_NS);
	int n = send_request(talk, request, MASTER_COMMAND);

	if (n)
		return n == -ENOBUFS || n == -EAGAIN ? -EIO : n == -ECONNREFUSED ? -ENODEV : n;
	while (progress.statuses < request->count) {
		n = receive_reply(talk, request->master, until);
		if (n < 0)
			return n;
		n = walk_datagram(talk, (size_t)n, take_message, &progress);
		if (n < 0)
			return n;
	}
	return 0;
}

struct list {
	uint32_t *numbers;
	unsigned count, room;
};

static int take_masters(void *ctx, const struct w1_head *head, const uint8_t *data, bool is_status)
{
	struct list *list = ctx;

	(void)is_status;
	if (head->type != LIST_MASTERS)
		return -EPROTO;
	for (size_t i = 0; i + 4 <= head->len && list->count < list->room; i += 4) {
		unsigned at = list->count++;
		uint32_t number;

		memcpy(&number, data + i, sizeof(number));
		for (; at && list->numbers[at - 1] > number; at--)
			list->numbers[at] = list->numbers[at - 1];
		list->numbers[at] = number;
	}
	return 0;
}

int w1_talk_masters(struct w1_talk *talk, uint32_t *numbers, unsigned room)
{
	struct list list = {.numbers = numbers, .room = room};
	struct w1_request request;
	int64_t until = bus_now(talk->env) + LIST_NS;
	int n;

	w1_request_begin(&request, 0);
	n = send_request(talk, &request, LIST_MASTERS);
	while (n == 0) {
		n = receive_datagram(talk, until);
		if (n >= 0)
			n = walk_datagram(talk, (size_t)n, take_masters, &list);
	}
	return n < 0 ? n : (int)list.count;
}
