// SPDX-License-Identifier: BSD-3-Clause
// `conus mcp` with the Model Context Protocol's own TypeScript SDK: node mcp.mjs, in a folder with node_modules,
// nested.nii.gz and wanted.tsv.
import { readFileSync } from "node:fs";
import { Client } from "@modelcontextprotocol/sdk/client/index.js";
import { StdioClientTransport } from "@modelcontextprotocol/sdk/client/stdio.js";

const client = new Client({ name: "test", version: "1" });
await client.connect(new StdioClientTransport({ command: process.env.CONUS, args: ["mcp"], env: process.env }));
const names = (await client.listTools()).tools.map((tool) => tool.name).join();
const answer = await client.callTool({
    name: "query",
    arguments: { atlas: "nested.nii.gz", origin: [0, 0, 90.5], toward: [0, 0, 0], angle: 20 },
});
const refused = await client.callTool({ name: "info", arguments: { atlas: "/etc/passwd" } });
await client.ping();
await client.close();
const cells = (text) => text.trim().split("\n").map((line) => line.split("\t"));
const [head, ...wanted] = cells(readFileSync("wanted.tsv", "utf8"));
const rows = answer.structuredContent.answer.Rows;
const same = rows.length === wanted.length && rows.every((row, i) =>
    head.every((name, k) => (typeof row[name] === "number" ? Math.abs(row[name] - wanted[i][k]) < 1e-5 :
        (row[name] ?? "n/a") === wanted[i][k])));
if (names !== "query,overlap,plan,info,cite,atlases" || answer.isError || !same || !refused.isError) {
    console.error(names, JSON.stringify(rows), JSON.stringify(refused));
    process.exit(1);
}
console.log(`mcp: ${rows.length} rows as the program has them`);
