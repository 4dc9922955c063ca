/* SPDX-License-Identifier: MIT */
/*
 * The chip families of this build, in the order of their codes: the one list of them. A new family
 * is one line here and one file. Included where FAMILY(code) says what is made of each.
 */
FAMILY(01) /* DS2401 */
FAMILY(05) /* DS2405 */
FAMILY(09) /* DS2502 */
FAMILY(10) /* DS18S20 */
FAMILY(12) /* DS2406 */
FAMILY(14) /* DS2430A */
FAMILY(1d) /* DS2423 */
FAMILY(20) /* DS2450 */
FAMILY(22) /* DS1822 */
FAMILY(23) /* DS2433 */
FAMILY(26) /* DS2438 */
FAMILY(28) /* DS18B20 */
FAMILY(29) /* DS2408 */
FAMILY(2d) /* DS2431 */
FAMILY(31) /* DS2720 */
FAMILY(3a) /* DS2413 */
FAMILY(3b) /* DS1825 */
FAMILY(42) /* DS28EA00 */
FAMILY(43) /* DS28EC20 */
