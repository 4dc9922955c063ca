/* SPDX-License-Identifier: MIT */
/* What people can do about a value that is not good, for each quality. */
#include <stddef.h>

#include "src/libows/ows.h"
#include "src/show/remedy.h"

static const struct {
	uint8_t quality;
	const char *text;
} remedies[] = {
	{OWS_Q_NO_PROPERTY, "check the path: owsctl dir shows what the device has"},
	{OWS_Q_TYPE, "choose another Type; owsctl read PATH shows the text"},
	{OWS_Q_ACCESS, "the property can only be read, or only be written"},
	{OWS_Q_NO_DEVICE, "the device does not answer: look at its plug, its cable and its ID"},
	{OWS_Q_DEVICE, "the device answers with errors: look at cable length, pull-up and noise"},
	{OWS_Q_SENSOR, "the sensor has lost its supply: look at its supply line"},
	{OWS_Q_STALE, "the value is too old: the bus is overloaded, or the device fails"},
	{OWS_Q_TARGET, "the target is down: look at its cable and its service"},
	{OWS_Q_SHORT, "data line and ground touch each other: look for the short circuit"},
	{OWS_Q_DIFFERS, "the device lost its command: look at its supply; Restore writes it again"},
	{OWS_Q_INITIAL, "nothing was read yet"},
	{OWS_Q_LAST_USABLE, "it is not read now: its target moves, or _ReadEnable is off"},
	{OWS_Q_RANGE, "the value is beyond Min or Max: look at the sensor"},
	{OWS_Q_LOW, "the value is below what its type or its Points can hold"},
	{OWS_Q_HIGH, "the value is above what its type or its Points can hold"},
	{OWS_Q_CUT, "the text is longer than the room for it"},
};

const char *remedy_of(uint8_t quality)
{
	for (size_t i = 0; i < sizeof(remedies) / sizeof(remedies[0]); i++)
		if (remedies[i].quality == quality)
			return remedies[i].text;
	return "";
}
