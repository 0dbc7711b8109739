"""The laws of the materials, measured from Python."""

import candela
from support import Case, main


class Laws(Case):
    def test_they_hold(self):
        rows = candela.furnace()
        self.assertGreater(len(rows), 5)
        self.assertTrue(all(row.kept for row in rows))
        self.assertEqual(candela.furnace_sheet().shape[2], 3)


if __name__ == "__main__":
    main()
