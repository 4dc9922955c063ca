/* SPDX-License-Identifier: MIT */
/* The words for the error of a request, and the remedy: one table for the log and for owsctl. */
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "src/signal/error.h"

static const struct {
	int err;
	const char *text, *remedy;
} errors[] = {
	{0, "no error", ""},
	/* what a path can be wrong in */
	{ENODEV, "no such device there", ""},
	{ENOENT, "no such property", "check its spelling; owsctl dir shows what a device has"},
	{EISDIR, "it is a directory", "owsctl dir shows the properties in it"},
	{ENOTDIR, "it is no directory", ""},
	{EILSEQ, "the answer is not a value of this type",
         "choose another Type; string takes any text"},
	{EPROTOTYPE, "the type does not fit the property", "the log says which Type fits"},
	{EMSGSIZE, "the answer is longer than the room for it",
         "choose a property that answers less"},
	{EACCES, "it can only be read, or only be written",
         "IO input reads it; IO output without Readable writes it"},
	{EBADRQC, "SetAlarm is not defined, or has no '='", "write SetAlarm \"property=value\""},
	{EUCLEAN, "it is still set after 0 was written", ""},
	{ENXIO, "not found, and a bridge chip of the target does not answer",
         "look at its supply, SDA, SCL"},
	{EPERM, "no permission",
         "a read-only server, or ControlAllow, refuses the write; a file of the kernel needs root or "
         "a udev rule"},
	/* what happens on the way */
	{EINVAL, "the target refuses this value", ""},
	{EBADMSG, "wrong checksum", ""},
	{EDOM, "a value out of the chip's range", ""},
	{ECOMM, "the wire is short", ""},
	{ERANGE, "reading of a sensor without power, or out of range", ""},
	{ETIME, "its turn did not come in time", ""},
	{ETIMEDOUT, "no answer in time", ""},
	{EINPROGRESS, "no answer in time; the device may have done it", ""},
	{ENOTCONN, "the target is down", ""},
	{ECONNREFUSED, "the target refuses the connection", ""},
	{ECONNRESET, "the target closed the connection", ""},
	{EPIPE, "the target closed the connection", ""},
	{EPROTO, "the target answered garbage", ""},
	{EOPNOTSUPP, "this target cannot do that", ""},
};
#define ERRORS (sizeof(errors) / sizeof(errors[0]))

static size_t error_find(int err)
{
	size_t i = 0;

	while (i < ERRORS && errors[i].err != -err)
		i++;
	return i;
}

const char *error_text(int err)
{
	size_t i = error_find(err);

	return i < ERRORS ? errors[i].text : strerror(-err);
}

const char *error_remedy(int err)
{
	size_t i = error_find(err);

	return i < ERRORS ? errors[i].remedy : "";
}

const char *error_words(int err, char words[ERROR_WORDS])
{
	const char *remedy = error_remedy(err);

	snprintf(words, ERROR_WORDS, "%s%s%s", error_text(err), *remedy ? ": " : "", remedy);
	return words;
}
