/* SPDX-License-Identifier: Apache-2.0 */
/*
 * page_words.h - the machine's own words, for the page's catalogue
 *
 * The page translates them; a word it does not have fails its build.
 */
#ifndef PANEL_PAGE_WORDS_H
#define PANEL_PAGE_WORDS_H

/** page_words_print() - faults with their words, states, outcomes, fields of a
 *  condition, as JSON on standard output. Return: to exit with. */
int page_words_print(void);

#endif /* PANEL_PAGE_WORDS_H */
