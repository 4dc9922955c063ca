/* SPDX-License-Identifier: MIT */
/* Addresses to listen at and ranges of peers: read, compared and printed. */
#include <arpa/inet.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/config/read/listen.h"

static const uint8_t v4_mapped[12] = {[10] = 0xff, [11] = 0xff};

static bool has_digits_only(const char *text, size_t len)
{
	for (size_t i = 0; i < len; i++)
		if (text[i] < '0' || text[i] > '9')
			return false;
	return len != 0;
}

/* The number that the whole text is, at most `most`; else -1. */
static long whole_number(const char *text, size_t len, long most)
{
	long value = 0;

	if (len > 5 || !has_digits_only(text, len))
		return -1;
	for (size_t i = 0; i < len; i++)
		value = value * 10 + (text[i] - '0');
	return value <= most ? value : -1;
}

static int parse_address(const char *text, size_t len, bool *is_v6, uint8_t bytes[16])
{
	char copy[INET6_ADDRSTRLEN];

	if (len == 0 || len >= sizeof(copy))
		return -EINVAL;
	memcpy(copy, text, len);
	copy[len] = '\0';
	memset(bytes, 0, 16);
	*is_v6 = memchr(copy, ':', len) != NULL;
	return inet_pton(*is_v6 ? AF_INET6 : AF_INET, copy, bytes) == 1 ? 0 : -EINVAL;
}

static int both_loopbacks(uint16_t port, struct listen_address addresses[2])
{
	addresses[0] = (struct listen_address){.bytes = {127, 0, 0, 1}, .port = port};
	addresses[1] = (struct listen_address){.is_v6 = true, .bytes = {[15] = 1}, .port = port};
	return 2;
}

/* The host of "host:port" and "[v6]:port", and where the port begins (NULL: none). */
static bool split_host(const char *text, size_t len, const char **host, size_t *host_len,
                       const char **port)
{
	const char *end = text + len, *close, *colon;

	*port = NULL;
	if (len && *text == '[') {
		close = memchr(text, ']', len);
		if (!close || (close + 1 < end && close[1] != ':'))
			return false;
		*host = text + 1;
		*host_len = (size_t)(close - *host);
		if (close + 1 < end)
			*port = close + 2;
		return memchr(*host, ':', *host_len) != NULL;
	}
	colon = memchr(text, ':', len);
	*host = text;
	*host_len = colon ? (size_t)(colon - text) : len;
	if (colon)
		*port = colon + 1;
	return !colon || !memchr(colon + 1, ':', (size_t)(end - colon - 1));
}

int listen_parse(const char *text, size_t len, struct listen_address addresses[2], const char **why)
{
	const char *host, *port_text;
	size_t host_len;
	long port = whole_number(text, len, 65535);

	if (port >= 0)
		return both_loopbacks((uint16_t)port, addresses);
	*why = "expected a port from 0 to 65535";
	if (has_digits_only(text, len))
		return -EINVAL;
	*why = "expected PORT, HOST:PORT or [IPv6]:PORT";
	if (!split_host(text, len, &host, &host_len, &port_text) || !host_len)
		return -EINVAL;
	port = port_text ? whole_number(port_text, (size_t)(text + len - port_text), 65535)
	                 : LISTEN_PORT;
	*why = "expected a port from 0 to 65535 after the colon";
	if (port < 0)
		return -EINVAL;
	if (host_len == 9 && memcmp(host, "localhost", 9) == 0)
		return both_loopbacks((uint16_t)port, addresses);
	*why = "expected an address of this machine such as 192.168.1.5 (0.0.0.0 and [::]: all), "
	       "or localhost";
	addresses[0] = (struct listen_address){.port = (uint16_t)port};
	return parse_address(host, host_len, &addresses[0].is_v6, addresses[0].bytes) ? -EINVAL : 1;
}

/* Make an IPv4 range in IPv6 form an IPv4 range, as listen_peers_have() looks peers up. */
static void as_v4(struct listen_peers *peers)
{
	if (!peers->is_v6 || peers->bits < 96 ||
	    memcmp(peers->bytes, v4_mapped, sizeof(v4_mapped)) != 0)
		return;
	peers->is_v6 = false;
	peers->bits -= 96;
	memmove(peers->bytes, peers->bytes + sizeof(v4_mapped), 4);
	memset(peers->bytes + 4, 0, 12);
}

int listen_peers_parse(const char *text, size_t len, struct listen_peers *peers, const char **why)
{
	const char *slash = memchr(text, '/', len);
	size_t host_len = slash ? (size_t)(slash - text) : len;
	long bits;

	*why = "expected an address or a range such as 192.168.1.0/24";
	if (parse_address(text, host_len, &peers->is_v6, peers->bytes))
		return -EINVAL;
	peers->bits = peers->is_v6 ? 128 : 32;
	bits = slash ? whole_number(slash + 1, len - host_len - 1, (long)peers->bits)
	             : (long)peers->bits;
	if (bits < 0)
		return -EINVAL;
	peers->bits = (unsigned)bits;
	as_v4(peers);
	return 0;
}

bool listen_same(const struct listen_address *a, const struct listen_address *b)
{
	return a->is_v6 == b->is_v6 && a->port == b->port &&
	       memcmp(a->bytes, b->bytes, sizeof(a->bytes)) == 0;
}

bool listen_same_peers(const struct listen_peers *a, const struct listen_peers *b)
{
	return a->is_v6 == b->is_v6 && a->bits == b->bits &&
	       memcmp(a->bytes, b->bytes, sizeof(a->bytes)) == 0;
}

bool listen_is_loopback(const struct listen_address *address)
{
	static const uint8_t v6[16] = {[15] = 1};

	return address->is_v6 ? memcmp(address->bytes, v6, 16) == 0 : address->bytes[0] == 127;
}

static bool same_bits(const uint8_t *a, const uint8_t *b, unsigned bits)
{
	unsigned rest = bits % 8;

	return memcmp(a, b, bits / 8) == 0 &&
	       (rest == 0 || ((a[bits / 8] ^ b[bits / 8]) >> (8 - rest)) == 0);
}

bool listen_peers_have(const struct listen_peers *peers, unsigned count, bool is_v6,
                       const uint8_t *bytes)
{
	if (is_v6 && memcmp(bytes, v4_mapped, sizeof(v4_mapped)) == 0) {
		is_v6 = false;
		bytes += sizeof(v4_mapped);
	}
	for (unsigned i = 0; i < count; i++)
		if (peers[i].is_v6 == is_v6 && same_bits(peers[i].bytes, bytes, peers[i].bits))
			return true;
	return false;
}

void listen_print_host(const struct listen_address *address, char text[LISTEN_TEXT_MAX])
{
	snprintf(text, LISTEN_TEXT_MAX, "?");
	inet_ntop(address->is_v6 ? AF_INET6 : AF_INET, address->bytes, text, LISTEN_TEXT_MAX);
}

void listen_print(const struct listen_address *address, char text[LISTEN_TEXT_MAX])
{
	char host[LISTEN_TEXT_MAX];

	listen_print_host(address, host);
	snprintf(text, LISTEN_TEXT_MAX, address->is_v6 ? "[%.45s]:%u" : "%.15s:%u", host,
	         (unsigned)address->port);
}

void listen_why(const struct listen_address *address, int err, char text[LISTEN_WHY_MAX])
{
	char at[LISTEN_TEXT_MAX];

	if (err == -EADDRNOTAVAIL) {
		listen_print_host(address, at);
		snprintf(text, LISTEN_WHY_MAX, "no interface of this machine has %s", at);
	} else {
		listen_print(address, at);
		snprintf(text, LISTEN_WHY_MAX, "cannot listen at %s: %s", at, strerror(-err));
	}
}

void listen_peers_print(const struct listen_peers *peers, char text[LISTEN_TEXT_MAX])
{
	char host[INET6_ADDRSTRLEN] = "?";

	inet_ntop(peers->is_v6 ? AF_INET6 : AF_INET, peers->bytes, host, sizeof(host));
	snprintf(text, LISTEN_TEXT_MAX, "%s/%u", host, peers->bits);
}

void listen_sockaddr(const struct listen_address *address, struct sockaddr_storage *to)
{
	struct sockaddr_in *v4 = (struct sockaddr_in *)to;
	struct sockaddr_in6 *v6 = (struct sockaddr_in6 *)to;

	memset(to, 0, sizeof(*to));
	if (address->is_v6) {
		v6->sin6_family = AF_INET6;
		v6->sin6_port = htons(address->port);
		memcpy(&v6->sin6_addr, address->bytes, sizeof(v6->sin6_addr));
	} else {
		v4->sin_family = AF_INET;
		v4->sin_port = htons(address->port);
		memcpy(&v4->sin_addr, address->bytes, sizeof(v4->sin_addr));
	}
}

bool listen_of(const struct sockaddr *from, struct listen_address *address)
{
	const struct sockaddr_in *v4 = (const void *)from;
	const struct sockaddr_in6 *v6 = (const void *)from;

	*address = (struct listen_address){.is_v6 = from->sa_family == AF_INET6};
	if (address->is_v6) {
		address->port = ntohs(v6->sin6_port);
		memcpy(address->bytes, &v6->sin6_addr, sizeof(v6->sin6_addr));
	} else if (from->sa_family == AF_INET) {
		address->port = ntohs(v4->sin_port);
		memcpy(address->bytes, &v4->sin_addr, sizeof(v4->sin_addr));
	} else {
		return false;
	}
	if (address->is_v6 && memcmp(address->bytes, v4_mapped, sizeof(v4_mapped)) == 0) {
		address->is_v6 = false;
		memmove(address->bytes, address->bytes + sizeof(v4_mapped), 4);
		memset(address->bytes + 4, 0, 12);
	}
	return true;
}
