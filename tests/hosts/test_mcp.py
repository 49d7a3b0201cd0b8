# SPDX-License-Identifier: BSD-3-Clause
"""`conus mcp` with the Model Context Protocol's own Python SDK: with a handshake and without."""
import asyncio
import json
import os
import subprocess

import pytest

mcp = pytest.importorskip("mcp")
CONUS = os.environ["CONUS"]


def rows(text):
    return json.loads(text)["Rows"]


@pytest.mark.parametrize("mode", ("auto", "legacy"))
def test_answers_are_those_of_the_program(tmp_path, mode):
    subprocess.run([CONUS, "phantom", "nested", "-o", tmp_path, "--size", "24"], check=True)
    words = ["query", "nested.nii.gz", "--origin=0,0,90.5", "--toward=0,0,0", "--angle=20", "--format=json"]
    wanted = rows(subprocess.run([CONUS, *words], check=True, capture_output=True, cwd=tmp_path).stdout)

    async def ask():
        server = mcp.StdioServerParameters(command=CONUS, args=["mcp", "--root", str(tmp_path)])
        async with mcp.Client(server, mode=mode) as client:
            tools = await client.list_tools()
            assert [tool.name for tool in tools.tools] == ["query", "overlap", "plan", "info", "cite", "atlases"]
            members = {"atlas": "nested.nii.gz", "origin": [0, 0, 90.5], "toward": [0, 0, 0], "angle": 20}
            answer = await client.call_tool("query", members)
            assert not answer.is_error and answer.structured_content["answer"]["Rows"] == wanted
            assert rows(json.dumps(json.loads(answer.content[0].text)["answer"])) == wanted
            refused = await client.call_tool("query", {**members, "atlas": "/etc/passwd"})
            assert refused.is_error and "--root FOLDER" in refused.content[0].text

    asyncio.run(ask())
