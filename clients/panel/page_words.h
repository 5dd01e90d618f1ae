/* SPDX-License-Identifier: Apache-2.0 */
/*
 * page_words.h - the machine's own words, for the page's catalogue
 *
 * The page translates these words. If the page lacks a word, its build fails.
 */
#ifndef PANEL_PAGE_WORDS_H
#define PANEL_PAGE_WORDS_H

/**
 * page_words_print() - print the faults with their words, the states, the
 * outcomes and the fields of a condition as JSON on standard output.
 *
 * Return: the exit code.
 */
int page_words_print(void);

#endif /* PANEL_PAGE_WORDS_H */
