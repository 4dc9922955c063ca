/* SPDX-License-Identifier: MIT */
/* The tables of reasons and remedies. */
#include <errno.h>
#include <mosquitto.h>
#include <netdb.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/mqtt/advice.h"

static const struct {
	int code;
	const char *words, *remedy;
} reasons[] = {
	{0x81, "the broker calls a packet malformed", ""},
	{0x82, "the broker calls it a protocol error", ""},
	{ADVICE_PROTOCOL, "the broker has not this version of MQTT", "Protocol \"3.1.1\""},
	{0x85, "the broker refuses the client id", "another Node gives another id"},
	{0x86, "the broker refuses user or password", "User and PasswordFile have to be its own"},
	{0x87, "the broker does not let us in", "User and PasswordFile, or its access list"},
	{0x88, "the broker is not available now", ""},
	{0x8a, "the broker has banned us", "look at its log"},
	{0x8b, "the broker ends", ""},
	{0x8d, "the broker did not hear from us in time", ""},
	{ADVICE_TAKEN_OVER, "another client took its place",
         "look for a second owsd-mqtt of this Node"},
	{0x95, "the broker calls a message too large",
         "raise there max_packet_size, message_size_limit"},
	{0x97, "the broker calls it too much", "raise its quota"},
	{0x9a, "the broker keeps no retained messages", "switch them on there"},
	{0x9b, "the broker has no QoS 1", "take another broker"},
	{0x9f, "the broker takes no more connections now", ""},
};

static size_t reason_of(int code)
{
	size_t i = 0;

	while (i < sizeof(reasons) / sizeof(reasons[0]) && reasons[i].code != code)
		i++;
	return i;
}

int advice_connack(int code, bool old)
{
	static const int codes[] = {0, ADVICE_PROTOCOL, 0x85, 0x88, 0x86, 0x87};

	if (old || code < 128)
		return code > 0 && code < 6 ? codes[code] : 0x87;
	return code;
}

const char *advice_words(int code, int err, const char *tls)
{
	size_t i = reason_of(code);

	if (i < sizeof(reasons) / sizeof(reasons[0]))
		return reasons[i].words;
	if (code >= 128)
		return mosquitto_reason_string(code);
	if (*tls)
		return tls;
	if (code == MOSQ_ERR_EAI)
		return err && err != EAI_SYSTEM ? gai_strerror(err)
		                                : "there is no host of that name";
	if (code == MOSQ_ERR_ERRNO)
		return err ? strerror(err) : "it has no address";
	return mosquitto_strerror(code);
}

/* Words of OpenSSL, which has one for a CA and a date that do not fit, and of libmosquitto. */
static const struct {
	const char *part, *remedy;
} tls_reasons[] = {
	/* of OpenSSL's check; else what it logs of all of these */
	{"has expired", "renew it there, or look at the clock here"},
	{"not yet valid", "set the clock of this machine"},
	{"issuer certificate", "CaFile has not the CA that signed it"},
	{"first certificate", "CaFile has not the CA that signed it"},
	{"self-signed", "CaFile has not the CA that signed it"},
	{"self signed", "CaFile has not the CA that signed it"},
	{"certificate verify failed", "look at CaFile, and at the clock of this machine"},
	{"host name verification failed", "write a name of its certificate in Broker"},
	{"certificate required", "the broker wants CertFile and KeyFile"},
	{"alert certificate expired", "look at the date of CertFile, and the clocks"},
	{"alert bad certificate", "look at CertFile and KeyFile"},
	{"alert unknown ca", "look at CertFile, and cafile of the broker"},
	{"wrong version number", "is that a port without TLS: mqtt://?"},
	{"unexpected eof", "is that a port without TLS: mqtt://?"},
};

static const char *tls_remedy(const char *tls)
{
	for (size_t i = 0; i < sizeof(tls_reasons) / sizeof(tls_reasons[0]); i++)
		if (strstr(tls, tls_reasons[i].part))
			return tls_reasons[i].remedy;
	return "";
}

const char *advice_hung_up(bool tls)
{
	return tls ? "is that a port without TLS: mqtt://?" : "does that port want TLS: mqtts://?";
}

const char *advice_remedy(int code, int err, const char *tls)
{
	size_t i = reason_of(code);

	if (i < sizeof(reasons) / sizeof(reasons[0]))
		return reasons[i].remedy;
	if (code < 128 && *tls_remedy(tls))
		return tls_remedy(tls);
	if (code == MOSQ_ERR_TLS)
		return "look at CaFile, and the name in Broker";
	if (code == MOSQ_ERR_EAI)
		return "correct Broker";
	if (code == MOSQ_ERR_ERRNO && err == ECONNREFUSED)
		return "does a broker run there?";
	if (code == MOSQ_ERR_ERRNO && (err == ETIMEDOUT || err == EHOSTUNREACH))
		return "look at its address and the network";
	return "";
}

const char *advice_closed(size_t len, const char *topic, const char **remedy,
                          char words[ADVICE_WORDS])
{
	*remedy = ADVICE_MAY_BE_LARGE;
	snprintf(words, ADVICE_WORDS, "the broker closes it at the message of %.100s, %zu bytes",
	         topic, len);
	return words;
}

bool advice_refuses(int code)
{
	return code != MOSQ_ERR_ERRNO && code != MOSQ_ERR_EAI && code != MOSQ_ERR_CONN_LOST &&
	       code != MOSQ_ERR_NO_CONN;
}

const char *advice_tls(const char *line)
{
	const char *last = strrchr(line, ':');

	/* "OpenSSL Error[0]: error:0A000086:SSL routines::certificate verify failed" */
	return strncmp(line, "OpenSSL Error", 13) == 0 && last && last[1] ? last + 1 : line;
}
