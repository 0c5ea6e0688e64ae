#!/usr/bin/env python3
"""Whether browsers run the script and use the style of each page, and all pages have the same: page_policy_test.py PAGE... A
page that was edited by hand lacks their hashes in its policy, and shows no run."""
import base64
import hashlib
import pathlib
import re
import sys


def main():
    first = {}
    for page in sys.argv[1:]:
        text = pathlib.Path(page).read_bytes().decode("utf-8")
        policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text).group(1)
        for element in ("script", "style"):
            contents = re.findall(rf"<{element}>(.*?)</{element}>", text, re.DOTALL)
            if len(contents) != 1:
                sys.exit(f"{page}: {len(contents)} times <{element}>")
            digest = base64.b64encode(hashlib.sha256(contents[0].encode("utf-8")).digest()).decode("ascii")
            if f"{element}-src 'sha256-{digest}'" not in policy:
                sys.exit(f"{page}: its policy forbids its {element}: make it with ./dev report-page or ./dev images")
            if first.setdefault(element, digest) != digest:
                sys.exit(f"{page}: its {element} is not that of {sys.argv[1]}: make both anew with ./dev report-page and ./dev images")
    print(f"{len(sys.argv) - 1} pages may use what is in them")


if __name__ == "__main__":
    main()
