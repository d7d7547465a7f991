"""Everything that coexists: what many simulated starts reach, joined with what continuation follows."""
