"""The page of a case and the table of a comparison state how each row is repeated."""

import re

import pandas as pd


def test_a_page_links_the_command_of_each_run_to_its_row(page_of_case):
    page = page_of_case.read_text(encoding="utf-8")
    commands = dict(re.findall(r'<a href="#(run-\w+)">(lacore [^<]+)</a>', page))
    rows = re.findall(r'<tr id="(run-\w+)"', page)
    assert rows
    assert set(commands) == set(rows)
    named = "lacore compare deformable-block:sliding --meshes coarse --backends clarabel"
    assert named in commands.values()


def test_a_page_states_the_command_of_each_program_once(page_of_case):
    page = page_of_case.read_text(encoding="utf-8")
    command = "lacore export deformable-block:sliding --meshes coarse"
    assert page.count(f"<td>{command}</td>") == 1
    assert page.count("<td>deformable-block-sliding-coarse.npz</td>") == 1


def test_the_table_of_all_runs_has_the_commands(compared):
    table = pd.read_csv(compared.parent / "results.csv")
    wall = table[table.case == "wall-1"].iloc[0]
    assert wall.repeat_command.startswith("lacore compare wall-1:mu-0.65 --backends ")
    assert wall.export_command == "lacore export wall-1:mu-0.65"
    assert wall.instance_file == "wall-1-mu-0.65-blocks.npz"
    assert table.repeat_command.notna().all()
