/* SPDX-License-Identifier: MIT */
/* Tests of why a broker is lost, in words, and of what a person can do about it. */
#include <errno.h>
#include <mosquitto.h>
#include <netdb.h>
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/advice.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_a_refusal_of_mqtt_3_is_the_same_as_that_of_mqtt_5(void)
{
	TEST_ASSERT_EQUAL_HEX8(ADVICE_PROTOCOL, advice_connack(1, true));
	TEST_ASSERT_EQUAL_HEX8(0x85, advice_connack(2, true));
	TEST_ASSERT_EQUAL_HEX8(0x88, advice_connack(3, true));
	TEST_ASSERT_EQUAL_HEX8(0x86, advice_connack(4, true));
	TEST_ASSERT_EQUAL_HEX8(0x87, advice_connack(5, true));
	/* a number that MQTT 3.1.1 does not have is a refusal like any */
	TEST_ASSERT_EQUAL_HEX8(0x87, advice_connack(6, true));
	TEST_ASSERT_EQUAL_HEX8(0x87, advice_connack(0x86, true));
	/* a broker of MQTT 3.1.1 answers a client of MQTT 5 with its own numbers */
	TEST_ASSERT_EQUAL_HEX8(ADVICE_PROTOCOL, advice_connack(1, false));
	TEST_ASSERT_EQUAL_HEX8(0x86, advice_connack(0x86, false));
	TEST_ASSERT_EQUAL_HEX8(128, advice_connack(128, false));
	TEST_ASSERT_EQUAL_HEX8(0x87, advice_connack(127, false));
}

static void test_each_reason_has_its_words_and_remedy(void)
{
	TEST_ASSERT_EQUAL_STRING("the broker refuses user or password", advice_words(0x86, 0, ""));
	TEST_ASSERT_EQUAL_STRING("User and PasswordFile have to be its own",
	                         advice_remedy(0x86, 0, ""));
	TEST_ASSERT_EQUAL_STRING("another client took its place",
	                         advice_words(ADVICE_TAKEN_OVER, 0, ""));
	TEST_ASSERT_EQUAL_STRING("the broker takes no more connections now",
	                         advice_words(0x9f, 0, ""));
	TEST_ASSERT_EQUAL_STRING("", advice_remedy(0x9f, 0, ""));
	/* the words of the library, for a reason without words of ours */
	TEST_ASSERT_EQUAL_STRING(mosquitto_reason_string(0x93), advice_words(0x93, 0, "tls"));
	TEST_ASSERT_EQUAL_STRING("", advice_remedy(0x93, 0, ""));
}

static void test_a_broker_that_closes_has_not_taken_the_longest_message(void)
{
	char words[ADVICE_WORDS];
	const char *remedy;

	TEST_ASSERT_EQUAL_STRING("the broker closes it at the message of owsd/pi7/a, 1000 bytes",
	                         advice_closed(1000, "owsd/pi7/a", &remedy, words));
	/* broker_fail() has room for so much of a remedy */
	TEST_ASSERT_LESS_THAN(50, (int)strlen(remedy));
}

static void test_what_tls_reported_goes_before_what_the_library_calls_it(void)
{
	TEST_ASSERT_EQUAL_STRING("certificate verify failed",
	                         advice_words(MOSQ_ERR_TLS, EPROTO, "certificate verify failed"));
	TEST_ASSERT_EQUAL_STRING("look at CaFile, and the name in Broker",
	                         advice_remedy(MOSQ_ERR_TLS, 0, ""));
	TEST_ASSERT_EQUAL_STRING(mosquitto_strerror(MOSQ_ERR_TLS),
	                         advice_words(MOSQ_ERR_TLS, 0, ""));
	/* ... but not before what the broker itself gave as a reason */
	TEST_ASSERT_EQUAL_STRING("the broker ends", advice_words(0x8b, 0, "wrong version number"));
}

static void test_a_name_that_is_not_found_is_told_from_an_address_that_is_refused(void)
{
	TEST_ASSERT_EQUAL_STRING(gai_strerror(EAI_AGAIN),
	                         advice_words(MOSQ_ERR_EAI, EAI_AGAIN, ""));
	TEST_ASSERT_EQUAL_STRING("there is no host of that name",
	                         advice_words(MOSQ_ERR_EAI, 0, ""));
	TEST_ASSERT_EQUAL_STRING("there is no host of that name",
	                         advice_words(MOSQ_ERR_EAI, EAI_SYSTEM, ""));
	TEST_ASSERT_EQUAL_STRING("correct Broker", advice_remedy(MOSQ_ERR_EAI, 0, ""));
	TEST_ASSERT_EQUAL_STRING("Connection refused",
	                         advice_words(MOSQ_ERR_ERRNO, ECONNREFUSED, ""));
	TEST_ASSERT_EQUAL_STRING("does a broker run there?",
	                         advice_remedy(MOSQ_ERR_ERRNO, ECONNREFUSED, ""));
	TEST_ASSERT_EQUAL_STRING("look at its address and the network",
	                         advice_remedy(MOSQ_ERR_ERRNO, ETIMEDOUT, ""));
	TEST_ASSERT_EQUAL_STRING("look at its address and the network",
	                         advice_remedy(MOSQ_ERR_ERRNO, EHOSTUNREACH, ""));
	TEST_ASSERT_EQUAL_STRING("", advice_remedy(MOSQ_ERR_ERRNO, EPIPE, ""));
	TEST_ASSERT_EQUAL_STRING("it has no address", advice_words(MOSQ_ERR_ERRNO, 0, ""));
	/* errno is left from something else, where the library did not fail by it */
	TEST_ASSERT_EQUAL_STRING("", advice_remedy(MOSQ_ERR_CONN_LOST, ECONNREFUSED, ""));
}

static void test_what_tls_reported_leads_to_its_remedy(void)
{
	TEST_ASSERT_EQUAL_STRING("look at CaFile, and at the clock of this machine",
	                         advice_remedy(MOSQ_ERR_TLS, 0, "certificate verify failed"));
	TEST_ASSERT_EQUAL_STRING("renew it there, or look at the clock here",
	                         advice_remedy(MOSQ_ERR_TLS, 0, "certificate has expired"));
	TEST_ASSERT_EQUAL_STRING("set the clock of this machine",
	                         advice_remedy(MOSQ_ERR_TLS, 0, "certificate is not yet valid"));
	TEST_ASSERT_EQUAL_STRING(
		"CaFile has not the CA that signed it",
		advice_remedy(MOSQ_ERR_TLS, 0, "unable to get local issuer certificate"));
	TEST_ASSERT_EQUAL_STRING(
		"CaFile has not the CA that signed it",
		advice_remedy(MOSQ_ERR_TLS, 0, "self-signed certificate in certificate chain"));
	TEST_ASSERT_EQUAL_STRING(
		"the broker wants CertFile and KeyFile",
		advice_remedy(MOSQ_ERR_PROTOCOL, 0, "tlsv13 alert certificate required"));
	TEST_ASSERT_EQUAL_STRING(
		"write a name of its certificate in Broker",
		advice_remedy(MOSQ_ERR_TLS, 0, "Error: host name verification failed."));
	TEST_ASSERT_EQUAL_STRING("is that a port without TLS: mqtt://?",
	                         advice_remedy(MOSQ_ERR_TLS, 0, "wrong version number"));
	TEST_ASSERT_EQUAL_STRING("look at CaFile, and the name in Broker",
	                         advice_remedy(MOSQ_ERR_TLS, 0, "something new"));
	/* a reason of the broker itself goes before */
	TEST_ASSERT_EQUAL_STRING("", advice_remedy(0x8b, 0, "certificate verify failed"));
	TEST_ASSERT_NOT_NULL(strstr(advice_hung_up(false), "mqtts://"));
	TEST_ASSERT_NOT_NULL(strstr(advice_hung_up(true), "mqtt://"));
}

/* broker.c has fifty letters for a remedy. */
static void test_no_remedy_is_cut(void)
{
	static const char *const tls[] = {
		"certificate verify failed", "certificate required",      "has expired",
		"first certificate",         "alert certificate expired", "alert bad certificate",
		"alert unknown ca",          "wrong version number"};

	for (size_t i = 0; i < sizeof(tls) / sizeof(tls[0]); i++) {
		size_t len = strlen(advice_remedy(MOSQ_ERR_TLS, 0, tls[i]));

		TEST_ASSERT_TRUE_MESSAGE(len > 0 && len <= 50, tls[i]);
	}
	for (int code = 0x80; code < 0xa3; code++)
		TEST_ASSERT_LESS_OR_EQUAL_size_t(50, strlen(advice_remedy(code, 0, "")));
}

static void test_of_a_line_of_the_log_the_part_for_people_is_taken(void)
{
	TEST_ASSERT_EQUAL_STRING(
		"certificate verify failed",
		advice_tls(
			"OpenSSL Error[0]: error:0A000086:SSL routines::certificate verify failed"));
	TEST_ASSERT_EQUAL_STRING("Error: no host", advice_tls("Error: no host"));
	TEST_ASSERT_EQUAL_STRING("OpenSSL Error[0]:", advice_tls("OpenSSL Error[0]:"));
	TEST_ASSERT_EQUAL_STRING("OpenSSL Error", advice_tls("OpenSSL Error"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_refusal_of_mqtt_3_is_the_same_as_that_of_mqtt_5);
	RUN_TEST(test_each_reason_has_its_words_and_remedy);
	RUN_TEST(test_a_broker_that_closes_has_not_taken_the_longest_message);
	RUN_TEST(test_what_tls_reported_goes_before_what_the_library_calls_it);
	RUN_TEST(test_a_name_that_is_not_found_is_told_from_an_address_that_is_refused);
	RUN_TEST(test_what_tls_reported_leads_to_its_remedy);
	RUN_TEST(test_no_remedy_is_cut);
	RUN_TEST(test_of_a_line_of_the_log_the_part_for_people_is_taken);
	return UNITY_END();
}
