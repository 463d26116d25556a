#!/usr/bin/env bash
# Writes which commit has passed `make test` into a file, for `make release-check`; of a tree with
# changes that are not committed it notes nothing.
# shellcheck source=tests/release/release_words
. "$(dirname "$0")/release_words"
rm -f "$root/$1"
cd "$root"
if is_clone "$root" && [ -z "$(git status --porcelain)" ]; then
	git rev-parse HEAD >"$1"
fi
