// SPDX-License-Identifier: Apache-2.0
import { render } from "preact";
import { App } from "./app";
import { link } from "./link";
import "./style.css";
import { apply } from "./use";

apply();
render(<App />, document.getElementById("app") as HTMLElement);
void link.start();
