// SPDX-License-Identifier: Apache-2.0
//
// Builds the page into EDM_PANEL_OUT.  Every file of it comes out of here:
// nothing is fetched from outside, and nothing is inline, as the panel's
// Content-Security-Policy demands.
import { defineConfig } from "vite";

export default defineConfig({
	base: "/",
	build: {
		outDir: process.env.EDM_PANEL_OUT || "../../../build/panel",
		emptyOutDir: true,
		target: "es2021",
		modulePreload: { polyfill: false },
		assetsInlineLimit: 0,
		chunkSizeWarningLimit: 900,
	},
	esbuild: { jsx: "automatic", jsxImportSource: "preact", legalComments: "none" },
});
