import { render } from "preact";
import { App } from "./app.tsx";
import { followLinks } from "./router.ts";
import { lookWho } from "./session.ts";
import { beginTheme } from "./theme.ts";
import "uplot/dist/uPlot.min.css";
import "./style/page.css";
import "./style/plots.css";
import "./style/studios.css";
import "./style/panel.css";

beginTheme();
followLinks();
void lookWho();
render(<App />, document.getElementById("page") as HTMLElement);
